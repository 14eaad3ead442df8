// SPDX-License-Identifier: BSD-3-Clause
#include "stated_errors.hpp"

#include <agrisee/cloud/volume.hpp>
#include <agrisee/locate.hpp>

#include <cmath>

#include "scan_doubts.hpp"

namespace agrisee {
namespace {

/// Set the standard error of a body's volume (m3), and that of its mass, which follows.
void set_volume_error(Body& body, double error, const MassParameters& parameters) {
  body.volume_error = error;
  body.mass_error = mass_of({body.volume, error}, parameters).error;
}

}  // namespace

void state_errors(const fuse::Views& map, const Parameters& parameters, std::vector<Fruit>& fruits) {
  std::vector<Body*> bodies;
  std::vector<Ellipsoid> ellipsoids;
  for (Fruit& f : fruits) {
    if (!f.body || f.found_by == "mask") continue;  // that of a mask's body is of its outlines
    bodies.push_back(&*f.body);
    ellipsoids.push_back(ellipsoid_of(*f.body));
  }
  const std::vector<fuse::BodyErrors> errors = map.body_errors(ellipsoids, parameters.split.bodies.fit);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (errors[i].center.isZero()) continue;
    Body& body = *bodies[i];
    body.center_covariance = body.center_covariance_by_shape + errors[i].center;
    set_volume_error(body, std::hypot(body.volume_error_by_shape, body.volume * errors[i].volume), parameters.mass);
  }
}

std::optional<std::string> doubt_calibration(const fuse::Views& map, const Parameters& parameters,
                                             std::vector<Fruit>& fruits) {
  std::vector<Ellipsoid> bodies;
  for (const Fruit& f : fruits)
    if (f.body) bodies.push_back(ellipsoid_of(*f.body));
  const fuse::CalibrationCheck check = map.check_calibration(bodies);
  std::size_t number = 0;
  for (Fruit& f : fruits) {
    if (!f.body) continue;
    Body& body = *f.body;
    const std::size_t b = number++;
    if (!check.misplaced.empty()) {
      body.center_covariance += check.misplaced[b].shift;
      set_volume_error(body, std::hypot(body.volume_error, body.volume * check.misplaced[b].volume), parameters.mass);
    }
    if (check.motion.isZero()) continue;
    constexpr double kSmaller = 0.75;  // of a body's relative volume, per motion in radii: its radius by a quarter
    const double smaller = kSmaller * body.volume * check.motion.norm() / body.radii.mean();
    body.center_covariance += check.motion * check.motion.transpose();
    set_volume_error(body, std::hypot(body.volume_error, smaller), parameters.mass);
  }
  return doubt_of(check);
}

}  // namespace agrisee
