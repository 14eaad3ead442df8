// SPDX-License-Identifier: BSD-3-Clause
#include "plant_foliage.hpp"

#include <agrisee/geometry/bvh.hpp>

#include <algorithm>
#include <cmath>

#include "plant_leaves.hpp"

namespace agrisee::study {

namespace {

/// Whether an edge of `mesh` passes through a triangle of `tree`. Edges with an end in the ball around `node` do not
/// count: there, the leaf grows out of its stem.
bool pierces(const Mesh& mesh, const Bvh& tree, const Eigen::Vector3f& node, float ball) {
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      if (t[i] > t[(i + 1) % 3]) continue;  // the other triangle of this edge has it in this direction
      if ((a - node).norm() < ball || (b - node).norm() < ball) continue;
      if (tree.any(a, b - a, 0.0f, 1.0f)) return true;
    }
  return false;
}

/// The leaves that stand, and the samples that they hide.
class Leaves {
 public:
  Leaves(const PlantLayout& layout, const Mesh& solids, const Samples& samples, const Flags& seen,
         const Eigen::Vector3d& eye)
      : node_ball_(static_cast<float>(layout.stem_radius + 0.012)), solids_(solids), eye_(eye.cast<float>()) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (seen[i]) open_.push_back(samples.points[i]);
    all_ = static_cast<double>(std::max<std::size_t>(1, open_.size()));
  }

  /// Whether a leaf that grows from `node` passes through nothing.
  bool fits(const CompoundLeaf& leaf, const Eigen::Vector3d& node) const {
    const Eigen::Vector3f n = node.cast<float>();
    const auto meets = [&](const Bvh& tree) {
      return pierces(leaf.stalks, tree, n, node_ball_) || pierces(leaf.blades, tree, n, 0.0f);
    };
    return !meets(solids_) && std::none_of(trees_.begin(), trees_.end(), meets);
  }
  /// Share of the samples that a leaf would hide beside those that are hidden already.
  double gain(const CompoundLeaf& leaf) const {
    Mesh mesh = leaf.blades;
    append(mesh, leaf.stalks);
    const Bvh tree(mesh);
    double hidden = 0.0;
    for (const Eigen::Vector3f& p : open_) hidden += tree.any(p, eye_ - p, 0.0f, 1.0f) ? 1.0 : 0.0;
    return hidden / all_;
  }
  /// Adds a leaf.
  void add(const CompoundLeaf& leaf) {
    Mesh mesh = leaf.blades;
    append(mesh, leaf.stalks);
    trees_.emplace_back(mesh);
    const Bvh& tree = trees_.back();
    const auto hidden = [&](const Eigen::Vector3f& p) { return tree.any(p, eye_ - p, 0.0f, 1.0f); };
    open_.erase(std::remove_if(open_.begin(), open_.end(), hidden), open_.end());
    foliage_.leaves.push_back(std::move(mesh));
    foliage_.share = 1.0 - static_cast<double>(open_.size()) / all_;
  }
  /// The samples that nothing hides yet.
  const std::vector<Eigen::Vector3f>& open() const { return open_; }
  /// The leaves so far.
  const Foliage& foliage() const { return foliage_; }

 private:
  float node_ball_;
  Bvh solids_;
  std::vector<Bvh> trees_;
  Eigen::Vector3f eye_;
  std::vector<Eigen::Vector3f> open_;
  double all_ = 1.0;
  Foliage foliage_;
};

/// Draws the point of a main stem from which a leaf grows, between two heights (m).
Eigen::Vector3d draw_node(const PlantLayout& layout, double low, double high, Rng& rng) {
  const Polyline& stem = layout.stems[rng.below(layout.stems.size())];
  const double z = rng.uniform(low, high);
  return layout.trough.empty() ? at_height(stem, z) : Eigen::Vector3d(stem.front() - Eigen::Vector3d(0, 0, 0.004));
}

/// Draws the course of a leaf from the stem to a place before the surface point `p`: over the top of the fruit, or past
/// one of their sides.
Polyline draw_course_before(const PlantLayout& layout, const Eigen::Vector3d& p, const Eigen::Vector3d& eye,
                            double scale, Rng& rng) {
  const Aabb& box = layout.fruits;
  const Eigen::Vector3d place = p + rng.uniform(0.018, 0.06) * (eye - p).normalized();
  const bool over = rng.uniform() < (layout.trough.empty() ? 0.45 : 0.8);
  const double top = box.max.z();
  const Eigen::Vector3d node =
      draw_node(layout, over ? top - 0.03 : place.z() - 0.03, over ? top + 0.13 : place.z() + 0.1, rng);
  Polyline through = {node};
  if (over) {
    const double high = std::max(top + rng.uniform(0.02, 0.06), node.z() + (layout.trough.empty() ? -0.02 : 0.03));
    through.emplace_back(0.4 * node.x() + 0.6 * place.x(), 0.45 * node.y() + 0.55 * place.y(), high);
    through.emplace_back(place.x(), place.y() - 0.008, place.z() + 0.4 * (high - place.z()));
  } else {
    const double side = place.x() + rng.uniform(-0.04, 0.04) < box.center().x() ? -1.0 : 1.0;
    const double x = (side < 0.0 ? box.min.x() : box.max.x()) + side * rng.uniform(0.012, 0.05);
    through.emplace_back(x, box.center().y() + rng.uniform(-0.02, 0.02), place.z() + rng.uniform(0.0, 0.07));
    through.emplace_back(0.6 * x + 0.4 * place.x(), place.y() - rng.uniform(0.0, 0.012),
                         place.z() + rng.uniform(0.005, 0.03));
  }
  through.push_back(place);
  const Eigen::Vector3d last = (place - through[through.size() - 2]).normalized();
  const Eigen::Vector3d end = (last + Eigen::Vector3d(0.0, -0.15, rng.uniform(-0.9, -0.3))).normalized();
  through.emplace_back(place + scale * rng.uniform(0.02, 0.05) * end);
  Polyline course = smooth_curve(through, 7);
  for (int pass = 0; pass < 12; ++pass)  // no stalk has a kink
    for (std::size_t i = 1; i + 1 < course.size(); ++i)
      course[i] = 0.25 * (course[i - 1] + 2.0 * course[i] + course[i + 1]);
  return course;
}

/// Draws the course of a leaf beside or behind the fruit.
Polyline draw_course_behind(const PlantLayout& layout, Rng& rng) {
  const Aabb& box = layout.fruits;
  const Eigen::Vector3d node = draw_node(layout, box.min.z(), box.max.z() + 0.16, rng);
  const double azimuth = rng.uniform(-0.35, kPi + 0.35), length = rng.uniform(0.14, 0.26);
  const double rise = rng.uniform(-0.05, 0.35) + (layout.trough.empty() ? 0.0 : 0.3);
  const double droop = layout.trough.empty() ? rng.uniform(0.1, 0.3) : rng.uniform(-0.2, 0.1);
  const Eigen::Vector3d out(std::cos(azimuth), std::sin(azimuth), 0.0), up(0.0, 0.0, length);
  return smooth_curve({node, node + 0.4 * length * out + rise * up, node + 0.78 * length * out + 0.9 * rise * up,
                       node + length * out + (0.7 * rise - droop) * up},
                      7);
}

}  // namespace

Foliage grow_leaves(const PlantParameters& parameters, const PlantStyle& style, const PlantLayout& layout,
                    const Mesh& solids, const Samples& samples, const Flags& seen, const Eigen::Vector3d& eye,
                    Rng& rng) {
  constexpr int kTries = 700;
  constexpr double kNear = 0.02;  // the share that is reached may miss the request by this much
  Leaves leaves(layout, solids, samples, seen, eye);
  const double nearest = layout.fruits.min.y() - 0.09;  // leaves stay this near to the fruit, out of the sensor's way
  const auto out_of_the_way = [&](const Mesh& mesh) {
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const auto& v) { return v.y() >= nearest; });
  };
  int since = 0;  // tries since the last leaf; the leaves become smaller with them
  for (int i = 0; i < kTries && !leaves.open().empty(); ++i, ++since) {
    const double missing = parameters.foliage - leaves.foliage().share;
    if (missing <= kNear) break;
    const double scale = std::max(0.4, 1.1 - since / 60.0) * rng.uniform(0.85, 1.1);
    const Eigen::Vector3d p = leaves.open()[rng.below(leaves.open().size())].cast<double>();
    const Polyline course = draw_course_before(layout, p, eye, scale, rng);
    const CompoundLeaf leaf = draw_compound_leaf(style.leaf, course, -Eigen::Vector3d::UnitY(), scale, rng);
    if (!out_of_the_way(leaf.blades) || !leaves.fits(leaf, course.front())) continue;
    const double gain = leaves.gain(leaf);
    if (gain > missing + kNear || gain < std::min(0.03, 0.5 * missing)) continue;
    leaves.add(leaf);
    since = 0;
  }
  const std::size_t before = leaves.foliage().leaves.size();
  const auto wanted = before + static_cast<std::size_t>(parameters.leaves_behind);
  for (int i = 0; i < 60 * parameters.leaves_behind && leaves.foliage().leaves.size() < wanted; ++i) {
    const Polyline course = draw_course_behind(layout, rng);
    const Eigen::Vector3d out = (course.back() - course.front()).normalized();
    const CompoundLeaf leaf = draw_compound_leaf(style.leaf, course, out, rng.uniform(0.8, 1.2), rng);
    if (leaves.fits(leaf, course.front()) && leaves.gain(leaf) == 0.0) leaves.add(leaf);
  }
  return leaves.foliage();
}

}  // namespace agrisee::study
