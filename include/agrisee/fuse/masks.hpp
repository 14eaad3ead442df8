// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence for bodies from a detector's masks and the depths under them, fused over all views. Metres, world frame;
/// images in pixels. Defined in `agrisee::agrisee`.
///
/// A mask is evidence, not truth. It proposes a body if its outline and depths form one, and each mask on the pixels of
/// a body changes that body's probability of being a fruit; in the end the points decide (cloud/bodies.hpp).
#pragma once

#include <agrisee/cloud/mask_evidence.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <memory>
#include <utility>
#include <vector>

namespace agrisee::fuse {

/// The evidence from the masks of one view; opaque.
struct ViewMasks;

/// A view that a detector has looked at, or that has colors. Copies share the frame.
struct DetectedView {
  DetectedView() = default;
  /// A view that shares a frame.
  DetectedView(std::shared_ptr<const sensor::DepthFrame> shared, const Pose& pose)
      : frame(std::move(shared)), world_T_optical(pose) {}
  /// A view that owns its frame; move the frame in to avoid a copy.
  DetectedView(sensor::DepthFrame own, const Pose& pose)
      : DetectedView(std::make_shared<const sensor::DepthFrame>(std::move(own)), pose) {}

  std::shared_ptr<const sensor::DepthFrame> frame;  ///< `detected` says whether a detector has looked at it
  Pose world_T_optical = Pose::Identity();          ///< pose of the camera
  std::shared_ptr<const ViewMasks> masks = {};      ///< result of read_masks; empty: not read yet
};

/// Read the masks of a view. Proposals are computed on first use, which takes some milliseconds per mask, and cached. A
/// scan therefore reads each view once and keeps the result in `DetectedView::masks`. Threads may use the result at the
/// same time.
/// @param view its frame and pose are used
/// @param bodies expected radii
/// @throws InputError as instances_of, for a view without frame and a pose that is not rigid; ParameterError; Cancelled
std::shared_ptr<const ViewMasks> read_masks(const DetectedView& view, const BodyParameters& bodies = {},
                                            const MaskParameters& parameters = {});

/// The instances of a frame, one per pixel, 0 = none: those of its label image and, for a detection that has a box but
/// no pixels in that image, the ellipse inscribed in the box. Where ellipses overlap, the larger score wins; pixels of
/// the label image keep their instance.
/// @throws InputError for a frame whose channels differ in size, an instance outside 1..65535 or listed twice, a score
///   outside 0..1
std::vector<std::uint16_t> instances_of(const sensor::DepthFrame& frame);

/// Which proposals come first.
enum class MaskOrder {
  masks_first,  ///< those of masks: a single view shows too little of a fruit for its points alone
  points_first  ///< those of points; masks propose bodies for what is left (MaskEvidence::remaining)
};

/// The evidence from the masks of some views.
///
/// **Proposals.** Each instance whose class is a fruit proposes a body:
/// 1. Its depth layer is the range, as deep as the largest expected radius, that holds most of its pixels; background
///    and flying pixels are left out.
/// 2. A border pixel lies on the fruit's outline unless the depth just outside is nearer than the fruit, as then
///    something occludes the fruit there. Of all cones through three border pixels the one is taken that has most of
///    the border on it, little of the mask outside, and few sight lines inside that go on behind the fruit.
/// 3. An ellipsoid is fitted to the sight lines on the outline, which touch it, and to the mean depth of its front
///    (silhouette.hpp). If much of the outline is hidden, its radius is pulled towards those of the fruit with visible
///    outlines (`alike`). Overlapping bodies of several views are fitted together.
///
/// **Log-odds of a body.** Among the pixels of a view at which the depth shows the body's surface, let a_i be the share
/// in instance i with the score s_i, and u the share without an instance. The view adds
///   sum_i +-a_i trust ln(s_i / (1 - s_i)) + u ln(1 - recall),
/// with minus for classes that are no fruit, and s_i limited by `max_score`. Errors of views are correlated, so the sum
/// over the n views that see the body is divided by sqrt(n); it is limited by `max_log_odds`.
///
/// **Log-odds of a proposal.** Its own masks count as a_i = 1 in their views, and
///   12.7 g + 1.75 b - 20 f - 8
/// is added, plus 1 for boxes, because other objects hide part of what is in a box. Here
/// - g is the share of the masks' pixels, without the rim, whose depth agrees with the body's to within a fifth of its
///   radius, apart from a common offset; pixels without depth count half;
/// - b is how far the depths bulge like the body, after a common offset and tilt (least squares; 1 for the body, 0 for
///   a plane, limited to -1 and 3);
/// - f = max(0, 0.4 - b - 2 standard errors) is positive if they surely do not.
///
/// The weights of g and b come from a logistic regression between the masks of a frame of real apples, also shifted by
/// three pixels to each side, and 150 masks of the same shapes and discs, placed at random on its leaves. The offset is
/// 1.25 below the regression's, because false detections look more like fruit than these.
/// @param views those that no detector has looked at are ignored; masks that have not been read are read
/// @param bodies expected radii
/// @param order with `points_first`, a mask half of whose pixels lie on a body is explained by it and proposes nothing
/// @throws InputError as instances_of, for views without frame and poses that are not rigid; ParameterError; Cancelled
MaskEvidence mask_evidence(const std::vector<DetectedView>& views, const BodyParameters& bodies = {},
                           const MaskParameters& parameters = {}, MaskOrder order = MaskOrder::masks_first);

}  // namespace agrisee::fuse
