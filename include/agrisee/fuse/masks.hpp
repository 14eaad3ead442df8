// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the masks of a detector to evidence for bodies: fused with the depths under them, over all views. Metres, world
/// frame; images in pixels. Defined in `agrisee::agrisee`.
///
/// A mask is evidence, not truth. It proposes a body where its outline and depths make one, and each mask on the pixels
/// of a body changes how far that body is believed; in the end the points decide (cloud/bodies.hpp).
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

/// What the masks of one view say, by itself; opaque.
struct ViewMasks;

/// A view that a detector has looked at, or that has colours. Copies share the frame.
struct DetectedView {
  DetectedView() = default;
  /// A view of a frame that is shared.
  DetectedView(std::shared_ptr<const sensor::DepthFrame> shared, const Pose& pose)
      : frame(std::move(shared)), world_T_optical(pose) {}
  /// A view of a frame of its own; move the frame in to avoid a copy.
  DetectedView(sensor::DepthFrame own, const Pose& pose)
      : DetectedView(std::make_shared<const sensor::DepthFrame>(std::move(own)), pose) {}

  std::shared_ptr<const sensor::DepthFrame> frame;  ///< a detector has looked at it where it says so (`detected`)
  Pose world_T_optical = Pose::Identity();          ///< pose of its camera
  std::shared_ptr<const ViewMasks> masks = {};      ///< what read_masks said of it; empty: not read yet
};

/// Read the masks of a view. What they propose is worked out when it is asked for, which takes some milliseconds a
/// mask, and kept; so a scan reads each view once and keeps the answer in `DetectedView::masks`.
/// @param view its frame and pose are used
/// @param bodies expected radii
/// @throws InputError as instances_of, and for a pose that is not rigid; ParameterError; Cancelled
std::shared_ptr<const ViewMasks> read_masks(const DetectedView& view, const BodyParameters& bodies = {},
                                            const MaskParameters& parameters = {});

/// The instances of a frame, one per pixel, 0 = none: those of its label image and, where a detection has a box and no
/// pixel in it, the ellipse inscribed in its box. Of ellipses that overlap, the one with the larger score has the
/// pixels; pixels of the label image keep their instance.
/// @throws InputError for a frame whose channels differ in size, an instance outside 1..65535 or listed twice, a score
///   outside 0..1
std::vector<std::uint16_t> instances_of(const sensor::DepthFrame& frame);

/// Which proposals come first.
enum class MaskOrder {
  masks_first,  ///< those of masks: a single view shows too little of a fruit for its points alone
  points_first  ///< those of points; masks propose bodies for what these leave (MaskEvidence::remaining)
};

/// What the masks of some views say.
///
/// Each instance of a class that is a fruit proposes a body. Its depth is the range, as deep as the largest expected
/// radius, that holds most of its pixels: pixels of the background and those that fly between are left out. A pixel at
/// its border lies on the fruit's outline unless the depth just outside is nearer than the fruit: then something hides
/// the fruit there. Of all cones through three border pixels the one is taken that has most of the border on it, little
/// of the mask outside, and in which few sight lines go on behind the fruit. An ellipsoid is fitted to the sight lines
/// on the outline, which graze it, and to the mean depth of its front (silhouette.hpp). Where much of the outline is
/// hidden, its radius is drawn to those of the fruit whose outlines are seen (`alike`). Bodies of several views that
/// overlap are fitted together.
///
/// The log-odds of a body. Of the pixels of a view in which the body's surface is what the depth shows, let a_i be the
/// share in instance i with the score s_i, and u the share without an instance. The view then says
///   sum_i +-a_i trust ln(s_i / (1 - s_i)) + u ln(1 - recall),
/// with minus for classes that are no fruit, and s_i limited by `max_score`. Errors of views are alike, so the sum over
/// n views that see the body is divided by sqrt(n); it is limited by `max_log_odds`. For a proposal, its own masks
/// count as a_i = 1 in their views; to its log-odds
///   12.7 g + 1.75 b - 20 f - 8
/// is added, and 1 for boxes, as other things hide part of what is in them. g is the share of its masks' pixels,
/// without those at the rim, at which the depth is that of the body to within a fifth of its radius, apart from a
/// common offset; pixels without depth count half. b says how much the depths bulge as the body does, beside a common
/// offset and tilt (least squares; 1 for the body, 0 for a plane, limited to -1 and 3), and f = max(0, 0.4 - b - 2
/// standard errors) that they surely do not. The weights of g and b are a logistic regression between the masks of a
/// frame of real apples, shifted by three pixels to each side too, and 150 masks of the same shapes and discs, laid at
/// random on its leaves; the offset is 1.25 below the regression's, as inventions of a detector look more like fruit
/// than these.
/// @param views those that no detector has looked at are left out; masks that have not been read are read
/// @param bodies expected radii
/// @param order with `points_first`, a mask that a body explains, as half of its pixels lie on that, proposes nothing
/// @throws InputError as instances_of, and for poses that are not rigid; ParameterError; Cancelled
MaskEvidence mask_evidence(const std::vector<DetectedView>& views, const BodyParameters& bodies = {},
                           const MaskParameters& parameters = {}, MaskOrder order = MaskOrder::masks_first);

}  // namespace agrisee::fuse
