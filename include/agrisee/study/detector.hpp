// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A simulated detector: masks of the fruit in an image, with typical errors.
///
/// Published detectors of greenhouse tomatoes reach a recall of 0.86 to 0.91 at a precision of 0.93 to 0.94 (Gao et
/// al., Traitement du Signal 39(1), 2022, doi 10.18280/ts.390130; YOLO v5 without and with their changes, the precision
/// from its F1 of 0.92). `typical` matches these rates. All other figures are assumed.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/study/raycast.hpp>

#include <cstdint>
#include <string>

namespace agrisee::study {

/// The errors of a detector. The defaults are those of a perfect one. Lengths in pixels.
struct DetectorParameters {
  double miss = 0.0;          ///< share of fully visible fruit that is missed
  double miss_hidden = 0.0;   ///< share of almost entirely hidden fruit that is missed; linear in between
  int least_pixels = 30;      ///< fruit with fewer visible pixels never has a mask
  double inventions = 0.0;    ///< false masks per ten fruit in the image; each has the shape of a true mask and lies on
                              ///< something else
  double merge = 0.0;         ///< share of the pairs of touching masks that become one mask
  double shift = 0.0;         ///< standard deviation of a mask's displacement, across and down (pixels)
  double erosion = 0.0;       ///< mean erosion of masks all around (pixels); negative: dilation
  double edge = 0.0;          ///< standard deviation of the edge about that, varying slowly along it (pixels)
  double alike = 0.0;         ///< share of the misses and false masks that are the same in all views of a scene
  double score = 1.0;         ///< mean score of true masks; one `score_spread` less for fruit half hidden
  double score_spread = 0.0;  ///< standard deviation of scores, true and false
  double false_score = 0.5;   ///< mean score of false masks
  double least_score = 0.25;  ///< masks with a lower score are not reported

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("miss", p.miss, Range::between(0.0, 1.0));
    f("miss_hidden", p.miss_hidden, Range::between(0.0, 1.0));
    f("least_pixels", p.least_pixels, Range::at_least(1));
    f("inventions", p.inventions, Range::not_negative().up_to(100.0));
    f("merge", p.merge, Range::between(0.0, 1.0));
    f("shift", p.shift, Range::not_negative());
    f("erosion", p.erosion, Range::between(-20.0, 20.0));
    f("edge", p.edge, Range::not_negative());
    f("alike", p.alike, Range::between(0.0, 1.0));
    f("score", p.score, Range::between(0.0, 1.0));
    f("score_spread", p.score_spread, Range::not_negative());
    f("false_score", p.false_score, Range::between(0.0, 1.0));
    f("least_score", p.least_score, Range::between(0.0, 1.0));
  }
};

/// The detectors by name.
constexpr std::array<const char*, 3> kDetectorNames{"perfect", "typical", "poor"};

/// The figures of a detector. @throws FieldError for a name that is not one of kDetectorNames
DetectorParameters detector_named(const std::string& name);

/// Simulate a detector in a view: sets `instances`, `detections` and `detected` of its frame. Where masks overlap, the
/// larger score wins.
/// @param frame of the view; its intrinsics are read
/// @param scene what the camera sees
/// @param rays of the frame's pixels
/// @param world_T_optical pose of the camera
/// @param parameters of the detector
/// @param seed, view select the random numbers, independently of those of the cameras
/// @throws ParameterError; InputError if the rays are not those of the frame
void detect(sensor::DepthFrame& frame, const TracedScene& scene, const RayImage& rays, const Pose& world_T_optical,
            const DetectorParameters& parameters, std::uint64_t seed, std::uint64_t view);

}  // namespace agrisee::study
