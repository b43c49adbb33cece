#include "applique/surface/surface_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

namespace applique {
namespace {

constexpr double weld_tolerance = 2e-7;

/// Gives each position the index of the first position within the tolerance. A hash grid with cells much
/// larger than the tolerance: nearly every position looks into one cell only.
class Welder {
 public:
  explicit Welder(std::span<const Vec3> positions) : positions_(positions) {
    if (positions.empty()) return;
    Vec3 lower = positions[0], upper = positions[0];
    for (const Vec3& p : positions) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
    origin_ = lower;
    tolerance_ = weld_tolerance * (upper - lower).norm();
    cell_ = tolerance_ > 0 ? 16 * tolerance_ : 1;
    cells_.resize(std::bit_ceil(2 * positions.size()), {0, none});
  }

  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> representative(positions_.size());
    next_.assign(positions_.size(), none);
    for (std::uint32_t i = 0; i < positions_.size(); ++i) representative[i] = find_or_add(i);
    return representative;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  std::uint32_t find_or_add(std::uint32_t i) {
    const Vec3 scaled = (positions_[i] - origin_) / cell_;
    const double reach = tolerance_ / cell_;
    std::array<std::int64_t, 3> low, high;
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<std::int64_t>(std::floor(scaled[k] - reach));
      high[k] = static_cast<std::int64_t>(std::floor(scaled[k] + reach));
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          for (std::uint32_t j = cell_of(key(x, y, z)).first; j != none; j = next_[j])
            if ((positions_[i] - positions_[j]).norm() <= tolerance_) return j;
        }
    const std::uint64_t own = key(static_cast<std::int64_t>(std::floor(scaled[0])),
                                  static_cast<std::int64_t>(std::floor(scaled[1])),
                                  static_cast<std::int64_t>(std::floor(scaled[2])));
    Cell& cell = cell_of(own);
    cell.key = own;
    next_[i] = cell.first;
    cell.first = i;
    return i;
  }

  struct Cell {
    std::uint64_t key;
    std::uint32_t first;  ///< Position in it; none where the table is free.
  };

  /// The place of a cell in the table, by linear probing: its own, or a free one.
  Cell& cell_of(std::uint64_t key) {
    const std::size_t mask = cells_.size() - 1;
    std::size_t at = (key ^ key >> 32) & mask;
    while (cells_[at].first != none && cells_[at].key != key) at = (at + 1) & mask;
    return cells_[at];
  }

  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ull ^
           static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4full ^
           static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ull;
  }

  std::span<const Vec3> positions_;
  Vec3 origin_ = Vec3::Zero();
  double tolerance_ = 0;
  double cell_ = 1;
  std::vector<Cell> cells_;          // a power of two, at most half of it taken
  std::vector<std::uint32_t> next_;  // next position in the same cell
};

/// One side of an edge: edge `edge` of face `face`, from vertex `from` to vertex `to`.
struct Side {
  VertexId low, high;  ///< The edge's vertices, sorted.
  FaceId face;
  std::uint8_t edge;
  bool forward;                                ///< Runs from low to high.
  std::array<std::uint32_t, 2> file_vertices;  ///< Input vertices at low and high.
};

void join(SurfaceMesh& mesh, const Side& a, const Side& b) {
  mesh.neighbours[a.face][a.edge] = b.face;
  mesh.neighbours[b.face][b.edge] = a.face;
  mesh.neighbour_edges[a.face][a.edge] = b.edge;
  mesh.neighbour_edges[b.face][b.edge] = a.edge;
}

/// Joins the sides of one edge; returns whether the edge is manifold (or a boundary).
bool join_edge(SurfaceMesh& mesh, std::span<Side> sides) {
  if (sides.size() == 1) return true;
  if (sides.size() == 2 && sides[0].forward != sides[1].forward) {
    join(mesh, sides[0], sides[1]);
    return true;
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.file_vertices, a.forward, a.face) < std::tie(b.file_vertices, b.forward, b.face);
  });
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first;
    while (last < sides.size() && sides[last].file_vertices == sides[first].file_vertices) ++last;
    if (last - first == 2 && sides[first].forward != sides[first + 1].forward)
      join(mesh, sides[first], sides[first + 1]);
    first = last;
  }
  return false;
}

/// The sides of all edges, sorted by vertices and face: into buckets of the lower vertex first, which are
/// small.
std::vector<Side> sorted_sides(const SurfaceMesh& mesh,
                               std::span<const std::array<std::uint32_t, 3>> triangles) {
  const auto lower = [&](FaceId f, int k) {
    return std::min(mesh.faces[f][(k + 1) % 3], mesh.faces[f][(k + 2) % 3]).value;
  };
  std::vector<std::uint32_t> start(mesh.positions.size() + 1, 0);
  for (FaceId f : ids<FaceId>(mesh.faces.size()))
    for (int k = 0; k < 3; ++k) ++start[lower(f, k) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Side> sides(3 * mesh.faces.size());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (FaceId f : ids<FaceId>(mesh.faces.size()))
    for (std::uint8_t k = 0; k < 3; ++k) {
      const int from = (k + 1) % 3, to = (k + 2) % 3;
      const VertexId a = mesh.faces[f][from], b = mesh.faces[f][to];
      const auto& input = triangles[mesh.source[f]];
      const bool forward = a < b;
      sides[next[lower(f, k)]++] = {
          std::min(a, b),
          std::max(a, b),
          f,
          k,
          forward,
          forward ? std::array{input[from], input[to]} : std::array{input[to], input[from]}};
    }
  for (std::size_t v = 0; v + 1 < start.size(); ++v)
    std::sort(sides.begin() + start[v], sides.begin() + start[v + 1], [](const Side& a, const Side& b) {
      return std::tie(a.high, a.face, a.edge) < std::tie(b.high, b.face, b.edge);
    });
  return sides;
}

void join_faces(SurfaceMesh& mesh, std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<Side> sides = sorted_sides(mesh, triangles);
  mesh.neighbours.resize(mesh.faces.size());
  mesh.neighbour_edges.resize(mesh.faces.size());
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first;
    while (last < sides.size() && sides[last].low == sides[first].low &&
           sides[last].high == sides[first].high)
      ++last;
    if (!join_edge(mesh, std::span(sides).subspan(first, last - first))) ++mesh.cut_edges;
    first = last;
  }
}

/// Walks every vertex's fans over the joined faces; the second and further fans get a vertex of their own.
void split_fans(SurfaceMesh& mesh) {
  mesh.vertex_face.resize(mesh.positions.size());
  mesh.degree.resize(mesh.positions.size(), 0);
  IdVector<FaceId, std::array<bool, 3>> visited(mesh.faces.size());
  for (FaceId first : ids<FaceId>(mesh.faces.size())) {
    for (int corner = 0; corner < 3; ++corner) {
      if (visited[first][corner]) continue;
      const VertexId old_vertex = mesh.faces[first][corner];
      VertexId v = old_vertex;
      if (mesh.vertex_face[v].valid()) {
        v = mesh.positions.push_back(Vec3(mesh.positions[old_vertex]));
        mesh.vertex_face.push_back(FaceId());
        mesh.degree.push_back(0);
        ++mesh.split_vertices;
      }
      mesh.vertex_face[v] = first;
      // Round the fan one way, and if that ends at a boundary, the other way from the start.
      for (int way = 0; way < 2; ++way) {
        FaceId f = first;
        int c = corner;
        while (f.valid() && !(visited[f][c] && f != first)) {
          if (!visited[f][c]) {
            visited[f][c] = true;
            mesh.faces[f][c] = v;
            ++mesh.degree[v];
          }
          const int edge = way == 0 ? (c + 2) % 3 : (c + 1) % 3;
          const FaceId next = mesh.neighbours[f][edge];
          if (!next.valid()) break;
          const int entry = mesh.neighbour_edges[f][edge];
          c = way == 0 ? (entry + 2) % 3 : (entry + 1) % 3;
          f = next;
          if (f == first) break;
        }
      }
    }
  }
}

void number_components(SurfaceMesh& mesh) {
  mesh.component = IdVector<VertexId, std::uint32_t>(mesh.positions.size(), 0);
  IdVector<FaceId, bool> seen(mesh.faces.size());
  std::vector<FaceId> stack;
  std::uint32_t count = 0;
  for (FaceId first : ids<FaceId>(mesh.faces.size())) {
    if (seen[first]) continue;
    seen[first] = true;
    stack.push_back(first);
    while (!stack.empty()) {
      const FaceId f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        mesh.component[mesh.faces[f][k]] = count;
        const FaceId next = mesh.neighbours[f][k];
        if (!next.valid() || seen[next]) continue;
        seen[next] = true;
        stack.push_back(next);
      }
    }
    ++count;
  }
}

}  // namespace

SurfaceMesh weld_surface(std::span<const Vec3> positions,
                         std::span<const std::array<std::uint32_t, 3>> triangles) {
  SurfaceMesh mesh;
  const std::vector<std::uint32_t> representative = Welder(positions).run();
  std::vector<VertexId> vertex(positions.size());
  const auto vertex_of = [&](std::uint32_t input) {
    VertexId& v = vertex[representative[input]];
    if (!v.valid()) v = mesh.positions.push_back(positions[representative[input]]);
    return v;
  };
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& input = triangles[t];
    for (std::uint32_t i : input) APPLIQUE_ASSERT(i < positions.size());
    const std::array r = {representative[input[0]], representative[input[1]], representative[input[2]]};
    if (r[0] == r[1] || r[1] == r[2] || r[2] == r[0]) {
      ++mesh.dropped_triangles;
      continue;
    }
    mesh.faces.push_back({vertex_of(input[0]), vertex_of(input[1]), vertex_of(input[2])});
    mesh.source.push_back(t);
  }
  join_faces(mesh, triangles);
  split_fans(mesh);
  number_components(mesh);
  return mesh;
}

Vec3 position_of(const SurfaceMesh& mesh, const SurfacePoint& point) {
  const std::array<Vec3, 3> corner = mesh.corners(point.face);
  return point.barycentric[0] * corner[0] + point.barycentric[1] * corner[1] +
         point.barycentric[2] * corner[2];
}

}  // namespace applique
