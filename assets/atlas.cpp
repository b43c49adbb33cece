#include "atlas.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <queue>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "flatten.h"
#include "pack.h"
#include "parallel.h"

namespace applique::assets {
namespace {

/// The triangle across each side (side i runs from corner i to i + 1).
std::vector<std::array<int, 3>> neighbours_across(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> owner;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i)
      owner[{mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]}] = static_cast<int>(t);
  std::vector<std::array<int, 3>> across(mesh.triangles.size(), {-1, -1, -1});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto other = owner.find({mesh.triangles[t][(i + 1) % 3], mesh.triangles[t][i]});
      if (other != owner.end()) across[t][i] = other->second;
    }
  return across;
}

/// Connected pieces of equal label, numbered from 0.
int number_pieces(const std::vector<std::array<int, 3>>& across, const std::vector<int>& label,
                  std::vector<int>& piece) {
  piece.assign(label.size(), -1);
  int count = 0;
  for (std::size_t start = 0; start < label.size(); ++start) {
    if (piece[start] >= 0) continue;
    std::vector<int> stack{static_cast<int>(start)};
    piece[start] = count;
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (const int n : across[t])
        if (n >= 0 && piece[n] < 0 && label[n] == label[t]) {
          piece[n] = count;
          stack.push_back(n);
        }
    }
    ++count;
  }
  return count;
}

/// The chart's own mesh, and for each of its vertices the one it came from.
FlatChart extract(const Mesh& mesh, const Charts& charts, int chart) {
  FlatChart flat;
  std::map<std::uint32_t, std::uint32_t> local;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (charts.of_triangle[t] != chart) continue;
    Triangle triangle;
    for (int i = 0; i < 3; ++i) {
      const auto [place, fresh] =
          local.try_emplace(mesh.triangles[t][i], static_cast<std::uint32_t>(local.size()));
      if (fresh) {
        flat.source.push_back(mesh.triangles[t][i]);
        flat.positions.push_back(mesh.positions[mesh.triangles[t][i]]);
      }
      triangle[i] = place->second;
    }
    flat.triangles.push_back(triangle);
  }
  return flat;
}

}  // namespace

Charts segment(const Mesh& mesh, const ChartRule& rule) {
  const auto across = neighbours_across(mesh);
  std::vector<int> label(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    const Vec3 a = mesh.positions[v[0]];
    const Vec3 b = mesh.positions[v[1]];
    const Vec3 c = mesh.positions[v[2]];
    label[t] = rule((a + b + c) / 3, (b - a).cross(c - a).normalized());
  }
  for (int round = 0; round < 4; ++round)
    for (std::size_t t = 0; t < label.size(); ++t) {
      const auto [a, b, c] = across[t];
      if (a < 0 || b < 0 || c < 0) continue;
      if (label[a] == label[b] || label[a] == label[c]) label[t] = label[a];
      if (label[b] == label[c]) label[t] = label[b];
    }
  // Every label keeps its largest piece; the others go, one at a time, to the neighbour they touch most.
  std::vector<int> piece;
  for (bool changed = true; changed;) {
    changed = false;
    const int count = number_pieces(across, label, piece);
    std::vector<int> size(count, 0);
    std::vector<int> piece_label(count, 0);
    for (std::size_t t = 0; t < label.size(); ++t) {
      ++size[piece[t]];
      piece_label[piece[t]] = label[t];
    }
    std::map<int, int> largest;
    for (int p = 0; p < count; ++p) {
      const auto [place, fresh] = largest.try_emplace(piece_label[p], p);
      if (!fresh && size[p] > size[place->second]) place->second = p;
    }
    for (int p = 0; p < count && !changed; ++p) {
      if (largest[piece_label[p]] == p) continue;
      std::map<int, int> touching;
      for (std::size_t t = 0; t < label.size(); ++t)
        if (piece[t] == p)
          for (const int n : across[t])
            if (n >= 0 && piece[n] != p) ++touching[label[n]];
      const auto most = std::max_element(touching.begin(), touching.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      for (std::size_t t = 0; t < label.size(); ++t)
        if (piece[t] == p) label[t] = most->first;
      changed = true;
    }
  }
  Charts charts;
  const int count = number_pieces(across, label, charts.of_triangle);
  charts.name.resize(count);
  for (std::size_t t = 0; t < label.size(); ++t) charts.name[charts.of_triangle[t]] = label[t];
  return charts;
}

Result<Mesh> unwrap(const Mesh& mesh, const Charts& charts, const ChartDensity& density, int size,
                    int gutter) {
  const auto count = static_cast<int>(charts.name.size());
  std::vector<FlatChart> flat(count);
  std::vector<std::string> failure(count);
  parallel_for(count, [&](int chart) {
    flat[chart] = extract(mesh, charts, chart);
    if (const auto done = flatten(flat[chart]); !done) failure[chart] = done.error().message;
  });
  for (int chart = 0; chart < count; ++chart)
    if (!failure[chart].empty()) {
      const Vec3 at = flat[chart].positions.front();
      return fail(ErrorCode::not_solved, fmt::format("chart {} near ({:.2f}, {:.2f}, {:.2f}): {}", chart,
                                                     at.x(), at.y(), at.z(), failure[chart]));
    }
  for (int chart = 0; chart < count; ++chart)
    for (Eigen::Vector2d& uv : flat[chart].uvs) uv *= density(charts.name[chart]);
  pack(flat, size, gutter);

  Mesh unwrapped;
  for (const FlatChart& chart : flat) {
    const auto base = static_cast<std::uint32_t>(unwrapped.positions.size());
    for (std::size_t v = 0; v < chart.source.size(); ++v) {
      unwrapped.positions.push_back(mesh.positions[chart.source[v]]);
      unwrapped.normals.push_back(mesh.normals[chart.source[v]]);
      unwrapped.uvs.emplace_back(chart.uvs[v].x() / size, 1 - chart.uvs[v].y() / size);
    }
    for (const Triangle& t : chart.triangles)
      unwrapped.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
  return unwrapped;
}

}  // namespace applique::assets
