# In C with FetchContent, which a clone stands in for: nothing is installed. normals.c is README's program.
echo 'cmake_minimum_required(VERSION 3.18)
project(normals C)
include(FetchContent)
FetchContent_Declare(ofc GIT_REPOSITORY https://example.org/ofc.git)
FetchContent_MakeAvailable(ofc)
add_executable(normals normals.c)
target_link_libraries(normals ofc::shared)' >CMakeLists.txt
cmake -S . -B build -DFETCHCONTENT_SOURCE_DIR_OFC="$clone"
cmake --build build
build/normals <ball.rgb >normals.f32
