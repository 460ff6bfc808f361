# In C++ with find_package() and OpenCV: normals.cpp is README's program.
cmake -S "$clone" -B library
cmake --build library
cmake --install library --prefix "$PWD/ofc"
echo 'cmake_minimum_required(VERSION 3.18)
project(normals CXX)
find_package(ofc 0.2 REQUIRED)
add_executable(normals normals.cpp)
target_include_directories(normals SYSTEM PRIVATE /usr/include/opencv4)
target_link_libraries(normals ofc::static opencv_imgcodecs opencv_core)' >CMakeLists.txt
CXXFLAGS=-std=c++17 cmake -S . -B build -DCMAKE_PREFIX_PATH="$PWD/ofc"
cmake --build build
build/normals ball.png normals.png
