#include "support/laplacians.h"

#include <algorithm>

namespace applique::laplacians {

Eigen::SparseMatrix<double> cotangent(const shapes::Soup& soup, const std::function<bool(const Vec3&)>& held,
                                      const std::function<double(std::size_t)>& weight) {
  std::vector<int> row(soup.positions.size(), -1);
  int rows = 0;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (!held(soup.positions[v])) row[v] = rows++;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto& v = soup.triangles[t];
      const Vec3& corner = soup.positions[v[k]];
      const Vec3 p = soup.positions[v[(k + 1) % 3]] - corner, q = soup.positions[v[(k + 2) % 3]] - corner;
      const double w = 0.5 * weight(t) * p.dot(q) / p.cross(q).norm();
      const auto [a, b] = std::minmax(row[v[(k + 1) % 3]], row[v[(k + 2) % 3]]);
      for (const int i : {a, b})
        if (i >= 0) entries.emplace_back(i, i, w);
      if (a >= 0) entries.emplace_back(b, a, -w);
    }
  Eigen::SparseMatrix<double> lower(rows, rows);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

}  // namespace applique::laplacians
