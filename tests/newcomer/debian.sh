# As Debian packages, which lintian looks at: normals.c is README's program. Unpacked here instead of installed.
cmake -S "$clone" -B build -DCMAKE_INSTALL_PREFIX=/usr -DOFC_HWCAPS=$([ "$(uname -m)" = x86_64 ] && echo ON || echo OFF)
cmake --build build
(cd build && cpack)
lintian --allow-root --fail-on error,warning build/*.deb
for package in build/*.deb; do dpkg-deb -x "$package" root; done
export PKG_CONFIG_PATH="$(echo root/usr/lib/*/pkgconfig)" LD_LIBRARY_PATH="$(echo root/usr/lib/*-linux-gnu)"
cc -std=c99 normals.c $(pkg-config --cflags --libs ofc) -o normals
./normals <ball.rgb >normals.f32
