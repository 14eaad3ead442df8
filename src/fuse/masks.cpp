// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/error.hpp>
#include <agrisee/core/log_odds.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/core/rigid_pose.hpp>
#include <agrisee/fuse/masks.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "fuse/mask_depths.hpp"
#include "fuse/mask_outline.hpp"

namespace agrisee::fuse {

/// A mask that proposes a body.
struct OwnMask {
  std::size_t image;  // its number
  std::uint16_t instance;
};

/// A body that masks propose, of one view or of several.
struct Proposal {
  std::vector<OwnMask> masks;
  std::vector<Silhouette> outlines;
  EllipsoidFit fit;

  /// The share of the outline that is seen, in the view that sees most of it.
  double seen() const {
    double most = 0.0;
    for (const Silhouette& s : outlines) most = std::max(most, s.seen);
    return most;
  }
};

struct ViewMasks {
  MaskImage image;
  BodyParameters bodies;
  MaskParameters parameters;

  ViewMasks(MaskImage read, const BodyParameters& expected, const MaskParameters& given)
      : image(std::move(read)), bodies(expected), parameters(given) {}

  /// What a mask of this view proposes. Threads may ask at the same time.
  const std::vector<Proposal>& proposals_of(std::uint16_t instance) const;

 private:
  mutable std::mutex mutex_;                                          // guards the map, not what is in it
  mutable std::map<std::uint16_t, std::vector<Proposal>> proposals_;  // of the masks that were asked for
};

namespace {

using Images = std::vector<std::shared_ptr<const ViewMasks>>;

/// Join proposals of a mask to those of other views at the same place, and add the others. Of each view one mask joins:
/// it has one outline of a body.
/// @param known those of other views, and of the same one from `before` on
/// @param number of the mask's image
void join(std::vector<Proposal>& known, std::size_t before, std::vector<Proposal> more, std::size_t number) {
  constexpr double kApart = 0.6;  // of the smaller radius
  for (Proposal& p : more) {
    p.masks.front().image = number;
    const Ellipsoid& body = p.fit.body;
    Proposal* nearest = nullptr;
    double least = 0.0;
    for (std::size_t i = 0; i < before; ++i) {
      const auto of_this_view = [number](const OwnMask& m) { return m.image == number; };
      if (std::any_of(known[i].masks.begin(), known[i].masks.end(), of_this_view)) continue;
      const Ellipsoid& other = known[i].fit.body;
      const double apart = (other.center - body.center).norm() / std::min(other.mean_radius(), body.mean_radius());
      if (apart < kApart && (!nearest || apart < least)) nearest = &known[i], least = apart;
    }
    if (!nearest) {
      known.push_back(std::move(p));
      continue;
    }
    nearest->masks.push_back(p.masks.front());
    nearest->outlines.push_back(std::move(p.outlines.front()));
    if (const auto fit = fit_silhouettes(nearest->outlines, nearest->fit.body, std::nullopt)) nearest->fit = *fit;
  }
}

/// The radius of the bodies whose outlines are seen, and how far they differ; empty where they are few.
std::optional<SizePrior> usual_radius(const std::vector<Proposal>& proposals) {
  constexpr double kSeen = 0.6, kLeastSpread = 0.08;
  constexpr std::size_t kFew = 5;
  std::vector<double> radii;
  for (const Proposal& p : proposals)
    if (p.seen() > kSeen) radii.push_back(p.fit.body.mean_radius());
  if (radii.size() < kFew) return std::nullopt;
  const double middle = median(radii);
  for (double& r : radii) r = std::abs(std::log(r / middle));
  return SizePrior{middle, std::max(kLeastSpread, 1.4826 * median(radii))};
}

/// How far an instance speaks for a fruit: +-trust ln(p / (1 - p)) of its score, limited by `max_score`.
double score_odds(const MaskImage& image, std::uint16_t instance, const MaskParameters& parameters) {
  const auto found = image.found.find(instance);
  const double score = found == image.found.end() ? 1.0 : found->second.score;
  const double odds = parameters.trust * log_odds(score, 1.0 - parameters.max_score);
  return found == image.found.end() || found->second.fruit ? odds : -odds;
}

/// What one view's masks say of a body; empty if the view does not show it.
/// @param step one of so many directions is looked at
std::optional<double> log_odds_in(const MaskImage& image, const Ellipsoid& body, const MaskParameters& parameters,
                                  std::size_t step) {
  constexpr double kDeep = 0.3;       // of the radius: a depth nearer to the surface shows it
  constexpr std::size_t kFewest = 5;  // directions
  const sensor::DepthFrame& frame = *image.frame;
  const Pose optical_T_world = image.world_T_optical.inverse();
  const Eigen::Vector3d sensor = image.world_T_optical.translation();
  const double deep = kDeep * body.mean_radius();
  std::size_t shown = 0;
  double sum = 0.0;
  const auto& directions = DirectionBins::directions();
  for (std::size_t i = 0; i < directions.size(); i += step) {
    const Eigen::Vector3d& d = directions[i];
    if (d.dot(sensor - body.center) <= 0.0) continue;
    const Eigen::Vector3d p = optical_T_world * body.surface(d);
    const auto pixel = frame.intrinsics.pixel_of(p);
    if (!pixel) continue;
    const float z = frame.depth[*pixel];
    if (!sensor::DepthFrame::valid(z) || std::abs(double(z) - p.z()) > deep) continue;
    ++shown;
    const std::uint16_t instance = image.instances[*pixel];
    sum += instance == 0 ? std::log(1.0 - parameters.recall) : score_odds(image, instance, parameters);
  }
  if (shown < kFewest) return std::nullopt;
  return sum / static_cast<double>(shown);
}

/// What the masks of all views say of a body. @param own the masks that proposed it, which are believed to be its
double log_odds_of(const Images& images, const Ellipsoid& body, const MaskParameters& parameters,
                   const std::vector<OwnMask>& own = {}) {
  constexpr std::size_t kMany = 4, kCoarse = 3;  // many views are looked at coarsely: together they show enough
  const std::size_t step = images.size() < kMany ? 1 : kCoarse;
  double sum = 0.0, views = 0.0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto mine = std::find_if(own.begin(), own.end(), [&](const OwnMask& m) { return m.image == i; });
    const auto odds = mine != own.end() ? std::optional(score_odds(images[i]->image, mine->instance, parameters))
                                        : log_odds_in(images[i]->image, body, parameters, step);
    if (odds) sum += *odds, views += 1.0;
  }
  if (!(views > 0.0)) return 0.0;
  return std::clamp(sum / std::sqrt(views), -parameters.max_log_odds, parameters.max_log_odds);
}

/// The log-odds of a proposal: what masks say of it, and the depths under its own.
double log_odds_of(const Images& images, const Proposal& proposal, const MaskParameters& parameters) {
  constexpr double kAgreement = 12.7, kBulge = 1.75, kFlatness = -20.0, kBoxed = 1.0, kOffset = -8.0;
  DepthsUnder mean;
  for (const OwnMask& m : proposal.masks) {
    const DepthsUnder one = judge_depths(images[m.image]->image, m.instance, proposal.fit.body);
    mean.agreement += one.agreement / static_cast<double>(proposal.masks.size());
    mean.bulge += one.bulge / static_cast<double>(proposal.masks.size());
    mean.boxed += one.boxed / static_cast<double>(proposal.masks.size());
    mean.flatness += one.flatness / static_cast<double>(proposal.masks.size());
  }
  return log_odds_of(images, proposal.fit.body, parameters, proposal.masks) + kAgreement * mean.agreement +
         kBulge * mean.bulge + kFlatness * mean.flatness + kBoxed * mean.boxed + kOffset;
}

/// Whether most of a mask's pixels show one of some bodies.
bool explained(const MaskImage& image, std::uint16_t instance, const std::vector<Ellipsoid>& bodies) {
  constexpr std::size_t kMost = 60;  // pixels that are looked at
  constexpr double kNear = 0.25;     // of the radius: a point nearer to the surface lies on it
  const std::vector<std::uint32_t>& pixels = image.pixels.at(instance);
  const auto width = static_cast<std::size_t>(image.frame->intrinsics.width);
  const Eigen::Vector3d sensor = image.world_T_optical.translation();
  std::size_t on = 0, off = 0;
  for (std::size_t i = 0; i < pixels.size(); i += pixels.size() / kMost + 1) {
    const std::uint32_t pixel = pixels[i];
    const double d = image.distance(pixel);
    if (!(d > 0.0)) continue;
    const Eigen::Vector3d p = sensor + d * image.direction(double(pixel % width), double(pixel / width));
    const bool shows = std::any_of(bodies.begin(), bodies.end(), [&](const Ellipsoid& body) {
      const double r = body.mean_radius();
      return (p - body.center).squaredNorm() < 2.0 * r * r && std::abs(body.distance(p)) < kNear * r;
    });
    ++(shows ? on : off);
  }
  return on >= off;
}

/// The bodies that the masks propose which no known body explains.
std::vector<MaskBody> proposed_bodies(const Images& images, const std::vector<Ellipsoid>& known,
                                      const BodyParameters& bodies, const MaskParameters& parameters) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const MaskImage& image = images[i]->image;
    const std::size_t before = proposals.size();
    for (const auto& [instance, pixels] : image.pixels) {
      const auto found = image.found.find(instance);
      if (found != image.found.end() && !found->second.fruit) continue;
      if (!known.empty() && explained(image, instance, known)) continue;
      join(proposals, before, images[i]->proposals_of(instance), i);
    }
  }
  const auto usual = parameters.alike ? usual_radius(proposals) : std::nullopt;
  std::vector<MaskBody> out;
  for (Proposal& p : proposals) {
    if (usual)
      if (const auto fit = fit_silhouettes(p.outlines, p.fit.body, usual)) p.fit = *fit;
    if (p.fit.inliers > 0 && bodies.plausible(p.fit.body.mean_radius()))
      out.push_back({p.fit, log_odds_of(images, p, parameters)});
  }
  return out;
}

}  // namespace

const std::vector<Proposal>& ViewMasks::proposals_of(std::uint16_t instance) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = proposals_.find(instance); known != proposals_.end()) return known->second;
  }
  std::vector<Proposal> own;  // remembered when it is complete: the work below may be cancelled
  for (const MaskGuess& guess : guess_bodies(image, instance, bodies, parameters)) {
    EllipsoidFit first;
    first.body = Ellipsoid(guess.sphere);
    const auto fit = fit_silhouettes({guess.outline}, first.body, std::nullopt);
    own.push_back({{{0, instance}}, {guess.outline}, fit ? *fit : first});
  }
  const std::lock_guard lock(mutex_);  // if another thread was faster, what it found stays: it is the same
  return proposals_.emplace(instance, std::move(own)).first->second;
}

std::shared_ptr<const ViewMasks> read_masks(const DetectedView& view, const BodyParameters& bodies,
                                            const MaskParameters& parameters) {
  bodies.check();
  parameters.check();
  check_input(view.frame != nullptr, "read_masks: a view has no frame");
  check_input(is_rigid(view.world_T_optical), "mask_evidence: the pose of a camera is not a rigid transform");
  return std::make_shared<const ViewMasks>(mask_image(view), bodies, parameters);
}

MaskEvidence mask_evidence(const std::vector<DetectedView>& views, const BodyParameters& bodies,
                           const MaskParameters& parameters, MaskOrder order) {
  bodies.check();
  parameters.check();
  MaskEvidence out;
  Images images;
  for (const DetectedView& view : views) {
    check_input(view.frame != nullptr, "mask_evidence: a view has no frame");
    if (view.frame->detected) images.push_back(view.masks ? view.masks : read_masks(view, bodies, parameters));
  }
  if (images.empty()) return out;
  out.log_odds = [images, parameters](const Ellipsoid& body) { return log_odds_of(images, body, parameters); };
  out.most = parameters.max_log_odds;
  if (order == MaskOrder::masks_first)
    out.bodies = proposed_bodies(images, {}, bodies, parameters);
  else
    out.remaining = [images, bodies, parameters](const std::vector<Ellipsoid>& known) {
      return proposed_bodies(images, known, bodies, parameters);
    };
  return out;
}

}  // namespace agrisee::fuse
