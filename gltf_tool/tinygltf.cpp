// The one place where tinygltf's code is compiled; its options are set for the whole library in
// CMakeLists.txt. It only parses geometry here: images stay as they are, and Draco is decoded in
// compression.cpp, because tinygltf 2.7 follows attribute ids that the stream does not have.
#define TINYGLTF_IMPLEMENTATION
#include <fstream>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>
