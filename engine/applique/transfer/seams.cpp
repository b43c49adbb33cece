#include "applique/transfer/seams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include <Eigen/SparseCholesky>

#include "applique/base/parallel.h"
#include "applique/image/decal_image.h"

namespace applique {
namespace {

constexpr double spacing = 0.5;            // texels between samples
constexpr double worn_seam = 8 / 255.0;    // a seam that the texture had before
constexpr double gutter_stiffness = 0.05;  // of a texel out of sight against one that shows
constexpr double at_odds = 1 / 255.0;      // two sides that differ by more
constexpr double insistence = 8;           // on a sample, times what it was
constexpr int most_steps = 40;             // each is a factorisation
constexpr int patience = 10;               // passes that bring nothing
constexpr double last_barrier = 1e-13;  // where values at a bound are at it, to less than a step of 16 bits
constexpr double first_room = 0.05;     // that values have to a bound, of what is between the two

int wrapped(std::int64_t texel, int size, WrapMode mode) {
  if (mode == WrapMode::clamp) return static_cast<int>(std::clamp<std::int64_t>(texel, 0, size - 1));
  const std::int64_t period = mode == WrapMode::repeat ? size : 2 * std::int64_t{size};
  const std::int64_t in = ((texel % period) + period) % period;
  return static_cast<int>(in < size ? in : period - 1 - in);
}

struct FitTerms {
  double agreement;                   ///< Stiffness of a sample's difference against a texel's change.
  double most_shown, most_in_gutter;  ///< How far a texel may go.
  int passes;  ///< Each weighs differences, which are linear light, by what they are where the last one came
               ///< to, and insists on the samples that are still at odds there.
};
FitTerms terms_of(SeamFit fit) {
  if (fit == SeamFit::exact) return {1e3, 1, 1, 40};
  return {6, 3 / 255.0, 16 / 255.0, 1};
}

/// A texel of one of the textures.
struct Place {
  std::uint32_t texture;
  std::uint32_t index;  ///< y * width + x
};

/// What a bilinear filter takes for one side of a sample.
struct Stencil {
  std::array<Place, 4> places;
  std::array<double, 4> weights;
  std::array<bool, 4> shown;  ///< The texel's centre lies on the triangle's side of the seam.
  std::array<Vec2, 2> axes;   ///< Of normals there: Seam::Side::axes.
};

/// Twice the area of the triangle, by its orientation.
double orientation(const Texel& a, const Texel& b, const Texel& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
}

Stencil stencil_at(const SeamTexture& texture, const Seam::Side& side, const Texel& p) {
  const double x = p[0] - 0.5, y = p[1] - 0.5, x0 = std::floor(x), y0 = std::floor(y);
  Stencil stencil{};
  for (std::size_t k = 0; k < 4; ++k) {
    const int right = static_cast<int>(k) % 2, down = static_cast<int>(k) / 2;
    const int column = wrapped(static_cast<std::int64_t>(x0) + right, texture.image->width, texture.wrap_u);
    const int row = wrapped(static_cast<std::int64_t>(y0) + down, texture.image->height, texture.wrap_v);
    stencil.places[k] = {side.texture, static_cast<std::uint32_t>(row * texture.image->width + column)};
    stencil.weights[k] = (right == 1 ? x - x0 : x0 + 1 - x) * (down == 1 ? y - y0 : y0 + 1 - y);
    const Texel centre = {x0 + right + 0.5, y0 + down + 0.5};
    stencil.shown[k] =
        orientation(side.ends[0], side.ends[1], centre) * orientation(side.ends[0], side.ends[1], side.apex) >
        0;
  }
  return stencil;
}

using Sample = std::array<Stencil, 2>;

std::vector<Sample> samples_along(std::span<const Seam> seams, std::span<const SeamTexture> textures) {
  std::vector<Sample> samples;
  for (const Seam& seam : seams) {
    double length = 0;
    for (const Seam::Side& side : seam.sides)
      length =
          std::max(length, std::hypot(side.ends[1][0] - side.ends[0][0], side.ends[1][1] - side.ends[0][1]));
    const int count = std::max(1, static_cast<int>(std::ceil(length / spacing)));
    for (int i = 0; i < count; ++i) {
      const double t = (i + 0.5) / count;
      Sample sample;
      for (std::size_t k = 0; k < 2; ++k) {
        const Seam::Side& side = seam.sides[k];
        const auto& ends = side.ends;
        sample[k] =
            stencil_at(textures[side.texture], side,
                       {(1 - t) * ends[0][0] + t * ends[1][0], (1 - t) * ends[0][1] + t * ends[1][1]});
        for (std::size_t c = 0; c < 2; ++c)
          sample[k].axes[c] = (1 - t) * side.axes[0][c] + t * side.axes[1][c];
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

bool is_changed(const SeamTexture& texture, std::uint32_t index) {
  return !std::equal(&texture.image->rgba[4 * std::size_t{index}],
                     &texture.image->rgba[4 * std::size_t{index}] + 4,
                     &texture.before->rgba[4 * std::size_t{index}]);
}

/// How a channel is stored.
struct Coding {
  bool srgb;
  [[nodiscard]] double decode(double stored) const { return srgb ? srgb_to_linear(stored) : stored; }
  [[nodiscard]] double encode(double value) const {
    value = std::clamp(value, 0.0, 1.0);
    return srgb ? linear_to_srgb(value) : value;
  }
  /// Stored steps per step of the value.
  [[nodiscard]] double slope(double value) const {
    if (!srgb) return 1;
    value = std::clamp(value, 0.0, 1.0);
    return value <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(value, 1 / 2.4 - 1);
  }
};

Coding coding_of(Encoding encoding, int channel) {
  return {encoding == Encoding::colour && channel < 3};
}

/// What the filter shows of the textures as they are, or as they were.
enum class State { now, before };
double filtered(const Stencil& stencil, std::span<const SeamTexture> textures, State state, int channel,
                const Coding& coding) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& [texture, index] = stencil.places[k];
    const Image& image = state == State::now ? *textures[texture].image : *textures[texture].before;
    sum += stencil.weights[k] * coding.decode(image.rgba[4 * std::size_t{index} + channel] / 65535.0);
  }
  return sum;
}

/// The same as it is stored, of all channels; the x and y of normals in the plane that both sides share.
std::array<double, 4> show(const Stencil& stencil, std::span<const SeamTexture> textures, State state,
                           Encoding encoding) {
  std::array<double, 4> values = {};
  for (int c = 0; c < 4; ++c) {
    const Coding coding = coding_of(encoding, c);
    values[static_cast<std::size_t>(c)] = coding.encode(filtered(stencil, textures, state, c, coding));
  }
  if (encoding == Encoding::normal) {
    const Vec2 across = (values[0] - 0.5) * stencil.axes[0] + (values[1] - 0.5) * stencil.axes[1];
    values[0] = across.real() + 0.5;
    values[1] = across.imag() + 0.5;
  }
  return values;
}

/// The texels that may change.
class Unknowns {
 public:
  Unknowns(const std::vector<Sample>& samples, std::span<const SeamTexture> textures) {
    for (const Sample& sample : samples)
      for (const Stencil& stencil : sample)
        for (std::size_t k = 0; k < 4; ++k) {
          const Place& place = stencil.places[k];
          const auto [slot, fresh] = slots_.try_emplace(key_of(place), fixed);
          if (fresh && is_changed(textures[place.texture], place.index)) {
            slot->second = static_cast<int>(places_.size());
            places_.push_back(place);
            shown_.push_back(false);
          }
          if (slot->second != fixed && stencil.shown[k])
            shown_[static_cast<std::size_t>(slot->second)] = true;
        }
  }

  static constexpr int fixed = -1;
  [[nodiscard]] int slot(const Place& place) const { return slots_.at(key_of(place)); }
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }
  [[nodiscard]] const std::vector<char>& shown() const { return shown_; }

 private:
  static std::uint64_t key_of(const Place& place) { return std::uint64_t{place.texture} << 32 | place.index; }
  std::unordered_map<std::uint64_t, int> slots_;
  std::vector<Place> places_;
  std::vector<char> shown_;
};

/// Samples that are to agree: with a texel to move, and not of a seam that shows through what the decal
/// leaves open.
std::vector<Sample> worth_joining(std::vector<Sample> samples, std::span<const SeamTexture> textures,
                                  Encoding encoding) {
  std::erase_if(samples, [&](const Sample& sample) {
    bool any = false, all = true;
    for (const Stencil& stencil : sample)
      for (const Place& place : stencil.places) {
        const bool changed = is_changed(textures[place.texture], place.index);
        any |= changed;
        all &= changed;
      }
    if (!any || all) return !any;
    const auto here = show(sample[0], textures, State::before, encoding);
    const auto there = show(sample[1], textures, State::before, encoding);
    for (std::size_t c = 0; c < 3; ++c)
      if (std::abs(here[c] - there[c]) > worn_seam) return true;
    return false;
  });
  return samples;
}

/// One channel of the texels, or two that make a direction of the plane: least squares within bounds, by a
/// primal-dual interior point method (Nocedal and Wright, "Numerical Optimization", 2006, 16.6). The values
/// are those of the first texel's channels, then of the next one's.
class Fit {
 public:
  Fit(const std::vector<Sample>& samples, const Unknowns& unknowns, std::span<const SeamTexture> textures,
      std::vector<int> channels, const Coding& coding, const FitTerms& terms)
      : samples_(samples),
        unknowns_(unknowns),
        textures_(textures),
        channels_(std::move(channels)),
        coding_(coding),
        terms_(terms) {
    const auto count = static_cast<Eigen::Index>(channels_.size() * unknowns.places().size());
    first_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) first_[i] = coding.decode(stored(i) / 65535.0);
    value_ = first_;
    lower_.resize(count);
    upper_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double reach = is_shown(i) ? terms.most_shown : terms.most_in_gutter;
      const double encoded = coding.encode(first_[i]);
      lower_[i] = coding.decode(std::max(0.0, encoded - reach));
      upper_[i] = coding.decode(std::min(1.0, encoded + reach));
    }
    agreement_.assign(samples.size(), terms.agreement);
  }

  void join() {
    if (largest_apart() <= at_odds) return;
    Eigen::VectorXd best = value_;
    double least = std::numeric_limits<double>::infinity();
    int since = 0;
    for (int pass = 0; pass < terms_.passes && least > at_odds && since < patience; ++pass) {
      assemble();
      if (!solve()) break;
      const double worst = insist();
      since = worst < least ? 0 : since + 1;
      if (worst < least) best = value_;
      least = std::min(least, worst);
    }
    value_ = best;
    for (Eigen::Index i = 0; i < value_.size(); ++i) {
      const double steps = textures_[place_of(i).texture].image->bits == 8 ? 255 : 65535;
      stored(i) =
          static_cast<std::uint16_t>(std::floor(coding_.encode(value_[i]) * steps + 0.5) * (65535 / steps));
    }
  }

 private:
  [[nodiscard]] std::size_t slot_of(Eigen::Index i) const {
    return static_cast<std::size_t>(i) / channels_.size();
  }
  [[nodiscard]] const Place& place_of(Eigen::Index i) const { return unknowns_.places()[slot_of(i)]; }
  [[nodiscard]] bool is_shown(Eigen::Index i) const { return unknowns_.shown()[slot_of(i)] != 0; }
  [[nodiscard]] std::uint16_t& stored(const Place& place, std::size_t c) const {
    return textures_[place.texture].image->rgba[4 * std::size_t{place.index} + channels_[c]];
  }
  [[nodiscard]] std::uint16_t& stored(Eigen::Index i) const {
    return stored(place_of(i), static_cast<std::size_t>(i) % channels_.size());
  }

  void assemble() {
    const Eigen::Index count = value_.size();
    std::vector<Eigen::Triplet<double>> entries;
    right_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double slope = coding_.slope(first_[i]);
      const double stiffness = (is_shown(i) ? 1 : gutter_stiffness) * slope * slope;
      entries.emplace_back(i, i, stiffness);
      right_[i] = stiffness * first_[i];
    }
    for (std::size_t i = 0; i < samples_.size(); ++i)
      for (const Difference& difference : differences(samples_[i]))
        add_difference(difference, agreement_[i], entries);
    matrix_.resize(count, count);
    matrix_.setFromTriplets(entries.begin(), entries.end());
  }

  /// One way in which a sample's sides differ, of the values.
  struct Difference {
    std::vector<std::pair<int, double>> row;  ///< Values and weights.
    double offset = 0;                        ///< Of what stays.
    double now = 0;
    double slope = 1;  ///< By how much what is stored changes with it.
    bool free = true;  ///< All its texels may change.
  };
  /// A channel's; or a direction's along both axes of the plane.
  [[nodiscard]] std::vector<Difference> differences(const Sample& sample) const {
    const bool plane = channels_.size() == 2;
    std::vector<Difference> list(channels_.size());
    for (std::size_t axis = 0; axis < list.size(); ++axis) {
      Difference& difference = list[axis];
      double mean = 0;
      for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t c = 0; c < channels_.size(); ++c) {
          const Vec2 along = plane ? sample[side].axes[c] : Vec2(1);
          const double share = (side == 0 ? 1 : -1) * (axis == 0 ? along.real() : along.imag());
          if (plane) difference.offset -= 0.5 * share;  // Where a texture has 0 of a direction.
          for (std::size_t k = 0; k < 4; ++k) {
            const Place& place = sample[side].places[k];
            const double weight = share * sample[side].weights[k];
            const int slot = unknowns_.slot(place);
            if (slot == Unknowns::fixed) {
              const double stays = coding_.decode(stored(place, c) / 65535.0);
              difference.free = false;
              difference.offset += weight * stays;
              mean += 0.5 * std::abs(weight) * stays;
              continue;
            }
            const int value = static_cast<int>(channels_.size()) * slot + static_cast<int>(c);
            difference.now += weight * value_[value];
            mean += 0.5 * std::abs(weight) * value_[value];
            difference.row.emplace_back(value, weight);
          }
        }
      difference.now += difference.offset;
      difference.slope = coding_.slope(mean);
    }
    return list;
  }

  void add_difference(const Difference& difference, double agreement,
                      std::vector<Eigen::Triplet<double>>& entries) {
    const double stiffness = agreement * difference.slope * difference.slope;
    for (const auto& [i, a] : difference.row) {
      right_[i] -= stiffness * a * difference.offset;
      for (const auto& [j, b] : difference.row) entries.emplace_back(i, j, stiffness * a * b);
    }
  }

  /// The largest difference of a sample's sides, as stored (0 to 1), of whatever texels.
  [[nodiscard]] double largest_apart() const {
    double largest = 0;
    for (const Sample& sample : samples_)
      for (const Difference& difference : differences(sample))
        largest = std::max(largest, std::abs(difference.now) * difference.slope);
    return largest;
  }

  /// Stiffens the samples that are still at odds though all their texels may change. The largest difference
  /// of such a one, as stored (0 to 1).
  double insist() {
    double worst = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      double apart = 0;
      for (const Difference& difference : differences(samples_[i]))
        if (difference.free) apart = std::max(apart, std::abs(difference.now) * difference.slope);
      worst = std::max(worst, apart);
      if (apart > at_odds) agreement_[i] *= insistence;
    }
    return worst;
  }

  /// The least of the sum within the bounds, from the values as they are: Mehrotra's predictor and corrector.
  /// Whether it was found; else they stay.
  bool solve() {
    using Array = Eigen::ArrayXd;
    const Array between = upper_ - lower_;
    Array value = value_.array().max(lower_ + first_room * between).min(upper_ - first_room * between);
    // What the bounds push with: at first what holds the values where they are.
    const Array pull = (matrix_ * value.matrix() - right_).array();
    const double least_push = pull.abs().mean() + 1e-6;
    Array up = pull.max(0) + least_push;
    Array down = (-pull).max(0) + least_push;
    for (int i = 0; i < most_steps; ++i) {
      const Array below = value - lower_;
      const Array above = upper_ - value;
      const double barrier = mean_barrier(below, up, above, down);
      if (barrier < last_barrier) break;
      Eigen::SparseMatrix<double> stiff = matrix_;
      stiff.diagonal() += (up / below + down / above).matrix();
      if (!analysed_) solver_.analyzePattern(stiff);
      analysed_ = true;
      solver_.factorize(stiff);
      if (solver_.info() != Eigen::Success) return false;
      const Array rest = right_.array() - (matrix_ * value.matrix()).array() + up - down;
      Array step;
      Array step_up;
      Array step_down;
      // To where each bound's push does what is wanted. How far that can be gone.
      const auto aim = [&](const Array& wanted_below, const Array& wanted_above) {
        const Eigen::VectorXd force = (rest + wanted_below / below - wanted_above / above).matrix();
        step = solver_.solve(force).array();
        step_up = (wanted_below - up * step) / below;
        step_down = (wanted_above + down * step) / above;
        return std::min(
            {within(below, step), within(above, -step), within(up, step_up), within(down, step_down)});
      };
      double length = aim(-up * below, -down * above);
      const double reached = mean_barrier(below + length * step, up + length * step_up, above - length * step,
                                          down + length * step_down);
      const double centre = barrier * std::pow(reached / barrier, 3);
      const Array bent_below = step * step_up;
      const Array bent_above = -step * step_down;
      length = aim(centre - up * below - bent_below, centre - down * above - bent_above);
      value += length * step;
      up += length * step_up;
      down += length * step_down;
    }
    if (!value.allFinite()) return false;
    value_ = value.matrix();
    return true;
  }

  static double mean_barrier(const Eigen::ArrayXd& below, const Eigen::ArrayXd& up,
                             const Eigen::ArrayXd& above, const Eigen::ArrayXd& down) {
    return ((below * up).mean() + (above * down).mean()) / 2;
  }

  /// How much of a step, at most all, leaves what is positive so.
  static double within(const Eigen::ArrayXd& left, const Eigen::ArrayXd& step) {
    constexpr double nearly = 0.99;
    double length = 1;
    for (Eigen::Index i = 0; i < left.size(); ++i)
      if (step[i] < 0) length = std::min(length, nearly * left[i] / -step[i]);
    return length;
  }

  const std::vector<Sample>& samples_;
  const Unknowns& unknowns_;
  std::span<const SeamTexture> textures_;
  std::vector<int> channels_;
  Coding coding_;
  FitTerms terms_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::VectorXd right_, first_, value_;
  Eigen::ArrayXd lower_, upper_;
  std::vector<double> agreement_;  ///< By sample.
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  bool analysed_ = false;
};

}  // namespace

std::vector<SeamSample> sample_seams(std::span<const Seam> seams, std::span<const SeamTexture> textures,
                                     Encoding encoding) {
  std::vector<SeamSample> result;
  for (const Sample& sample : samples_along(seams, textures)) {
    SeamSample shown{{}, true};
    for (std::size_t side = 0; side < 2; ++side) {
      for (const Place& place : sample[side].places)
        shown.changed &= is_changed(textures[place.texture], place.index);
      shown.colours[side] = show(sample[side], textures, State::now, encoding);
    }
    result.push_back(shown);
  }
  return result;
}

void join_seams(std::span<const Seam> seams, std::span<const SeamTexture> textures, Encoding encoding,
                SeamFit fit) {
  const std::vector<Sample> samples = worth_joining(samples_along(seams, textures), textures, encoding);
  if (samples.empty()) return;
  const Unknowns unknowns(samples, textures);
  std::vector<std::vector<int>> fits = {{0}, {1}, {2}, {3}};
  if (encoding == Encoding::normal) fits = {{0, 1}, {2}};
  parallel_for(static_cast<int>(fits.size()), [&](int i) {
    const std::vector<int>& channels = fits[static_cast<std::size_t>(i)];
    const bool writes = std::any_of(textures.begin(), textures.end(), [&](const SeamTexture& texture) {
      return texture.channels[static_cast<std::size_t>(channels.front())];
    });
    if (writes)
      Fit(samples, unknowns, textures, channels, coding_of(encoding, channels.front()), terms_of(fit)).join();
  });
}

}  // namespace applique
