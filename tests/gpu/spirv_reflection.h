#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace applique {

/// What a shader says about itself, read from its SPIR-V.
struct SpirvReflection {
  std::array<std::uint32_t, 3> local_size = {0, 0, 0};
  std::vector<std::uint32_t> bindings;  ///< Sorted; of set 0.
  std::uint32_t push_size = 0;          ///< Bytes of the push constants.
};

inline SpirvReflection reflect_spirv(std::span<const std::uint32_t> words) {
  constexpr std::uint32_t op_execution_mode = 16, op_type_int = 21, op_type_float = 22, op_type_vector = 23,
                          op_type_struct = 30, op_type_pointer = 32, op_variable = 59, op_decorate = 71,
                          op_member_decorate = 72, mode_local_size = 17, decoration_binding = 33,
                          decoration_offset = 35, storage_push_constant = 9;
  SpirvReflection result;
  std::map<std::uint32_t, std::uint32_t> sizes, pointees;
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> offsets;
  std::map<std::uint32_t, bool> bound;
  std::uint32_t push_pointer = 0;
  for (std::size_t i = 5; i < words.size(); i += words[i] >> 16) {
    const std::uint32_t op = words[i] & 0xffffu, count = words[i] >> 16;
    const auto word = [&](std::uint32_t k) { return words[i + k]; };
    if (op == op_execution_mode && word(2) == mode_local_size)
      result.local_size = {word(3), word(4), word(5)};
    if (op == op_decorate && word(2) == decoration_binding) bound[word(3)] = true;
    if (op == op_member_decorate && word(3) == decoration_offset) offsets[word(1)][word(2)] = word(4);
    if (op == op_type_int || op == op_type_float) sizes[word(1)] = word(2) / 8;
    if (op == op_type_vector) sizes[word(1)] = sizes[word(2)] * word(3);
    if (op == op_type_struct) {
      for (std::uint32_t k = 2; k < count; ++k) members[word(1)].push_back(word(k));
      if (count > 2) sizes[word(1)] = offsets[word(1)][count - 3] + sizes[members[word(1)].back()];
    }
    if (op == op_type_pointer) pointees[word(1)] = word(3);
    if (op == op_variable && word(3) == storage_push_constant) push_pointer = word(1);
  }
  for (const auto& [binding, is_bound] : bound) {
    if (is_bound) result.bindings.push_back(binding);
  }
  if (push_pointer) result.push_size = sizes[pointees[push_pointer]];
  return result;
}

}  // namespace applique
