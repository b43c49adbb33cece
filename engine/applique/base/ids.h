#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "applique/base/error.h"

namespace applique {

/// A 32-bit index that knows what it indexes: ids of different kinds do not mix.
template <class Tag>
struct Id {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = none;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  [[nodiscard]] constexpr bool valid() const { return value != none; }
  constexpr auto operator<=>(const Id&) const = default;
};

/// A vector indexed only by its own kind of id.
template <class IdType, class T>
class IdVector {
 public:
  IdVector() = default;
  explicit IdVector(std::size_t size, const T& value = T()) : items_(size, value) {}
  explicit IdVector(std::vector<T> items) : items_(std::move(items)) {}

  decltype(auto) operator[](IdType id) { return items_[id.value]; }
  decltype(auto) operator[](IdType id) const { return items_[id.value]; }
  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] bool empty() const { return items_.empty(); }
  void resize(std::size_t size, const T& value = T()) { items_.resize(size, value); }
  void reserve(std::size_t size) { items_.reserve(size); }
  void clear() { items_.clear(); }
  IdType push_back(T value) {
    items_.push_back(std::move(value));
    return IdType(items_.size() - 1);
  }
  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  std::vector<T>& raw() { return items_; }
  const std::vector<T>& raw() const { return items_; }

 private:
  std::vector<T> items_;
};

/// `for (FaceId f : ids<FaceId>(n))`: all ids from 0 to n-1.
template <class IdType>
class IdRange {
 public:
  struct Iterator {
    std::uint32_t value;
    IdType operator*() const { return IdType(value); }
    Iterator& operator++() {
      ++value;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return value != other.value; }
  };
  explicit IdRange(std::size_t size) : size_(static_cast<std::uint32_t>(size)) {}
  [[nodiscard]] Iterator begin() const { return {0}; }
  [[nodiscard]] Iterator end() const { return {size_}; }

 private:
  std::uint32_t size_;
};

template <class IdType>
IdRange<IdType> ids(std::size_t size) {
  return IdRange<IdType>(size);
}

using VertexId = Id<struct VertexTag>;            ///< A vertex of the welded surface.
using FaceId = Id<struct FaceTag>;                ///< A triangle of the welded surface.
using PatchVertexId = Id<struct PatchVertexTag>;  ///< A vertex of a patch; several may lie over one VertexId.
using PatchFaceId = Id<struct PatchFaceTag>;      ///< A triangle of a patch; several may lie over one FaceId.

}  // namespace applique

template <class Tag>
struct std::hash<applique::Id<Tag>> {
  std::size_t operator()(applique::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>()(id.value); }
};
