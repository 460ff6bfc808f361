# In C, with pkg-config: normals.c is README's program.
cmake -S "$clone" -B build
cmake --build build
cmake --install build --prefix "$PWD/ofc"
export PKG_CONFIG_PATH="$PWD/ofc/lib/pkgconfig" LD_LIBRARY_PATH="$PWD/ofc/lib"
cc -std=c99 normals.c $(pkg-config --cflags --libs ofc) -o normals
./normals <ball.rgb >normals.f32
