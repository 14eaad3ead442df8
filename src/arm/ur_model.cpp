// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/ur_model.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

namespace agrisee::arm {

namespace {

UrModel member(std::string_view name, const std::array<double, 6>& lengths, double shoulder_offset, double elbow_offset,
               double thickness, const JointLimits& limits) {
  UrModel model{name, lengths[0], lengths[1], lengths[2], lengths[3], lengths[4], lengths[5], {}, limits};
  model.pieces = stretched_pieces(model, shoulder_offset, elbow_offset, thickness);
  return model;
}

JointLimits with_speeds(double base_and_shoulder, double elbow, double wrists) {
  JointLimits limits;
  limits.velocity << base_and_shoulder, base_and_shoulder, elbow, wrists, wrists, wrists;
  return limits;
}

}  // namespace

std::string_view to_string(Part part) {
  constexpr std::array<std::string_view, 8> names{"shoulder", "upper_arm", "forearm", "wrist_1",
                                                  "wrist_2",  "wrist_3",   "base",    "sensor"};
  return names[static_cast<std::size_t>(part)];
}

Piece make_piece(Part part, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  const OrientedCylinder cylinder{0.5 * (a + b), (b - a).normalized(), radius, (b - a).norm()};
  return {part, cylinder, enclosing_capsule(cylinder)};
}

const std::array<Piece, 15>& ur3_pieces() {
  static const std::array<Piece, 15> pieces{
      make_piece(Part::shoulder, {0.0, 0.0, -0.0665}, {0.0, 0.0, 0.0575}, 0.0525),
      make_piece(Part::shoulder, {0.0, -0.0545, 0.0}, {0.0, -0.026, 0.0}, 0.046),
      make_piece(Part::upper_arm, {0.0, 0.0, 0.0535}, {0.0, 0.0, 0.1775}, 0.0525),
      make_piece(Part::upper_arm, {-0.0885, 0.0, 0.12}, {-0.0255, 0.0, 0.12}, 0.0465),
      make_piece(Part::upper_arm, {-0.2215, 0.0, 0.12}, {-0.0885, 0.0, 0.12}, 0.039),
      make_piece(Part::upper_arm, {-0.24365, 0.0, 0.069}, {-0.24365, 0.0, 0.1775}, 0.044),
      make_piece(Part::forearm, {0.0, 0.0, 0.0115}, {0.0, 0.0, 0.079}, 0.042),
      make_piece(Part::forearm, {-0.2005, 0.0, 0.0275}, {0.003, 0.0, 0.0275}, 0.0355),
      make_piece(Part::forearm, {-0.21325, 0.0, -0.0195}, {-0.21325, 0.0, 0.0705}, 0.0345),
      make_piece(Part::wrist_1, {0.0, -0.043, 0.0}, {0.0, 0.047, 0.0}, 0.037),
      make_piece(Part::wrist_1, {0.0, 0.0, -0.047}, {0.0, 0.0, -0.018}, 0.033),
      make_piece(Part::wrist_2, {0.0, -0.0485, 0.0}, {0.0, 0.041, 0.0}, 0.0365),
      make_piece(Part::wrist_2, {0.0, 0.0, -0.047}, {0.0, 0.0, -0.0175}, 0.0345),
      make_piece(Part::wrist_3, {0.0, 0.0, -0.042}, {0.0, 0.0, -0.001}, 0.0365),
      make_piece(Part::base, {0.0, 0.0, -0.001}, {0.0, 0.0, 0.0865}, 0.0655),
  };
  return pieces;
}

void UrModel::check() const {
  const auto positive = [](double length) { return length > 0.0 && std::isfinite(length); };
  check_parameter(std::isfinite(d1), "UrModel::d1", "finite", d1);
  check_parameter(positive(-a2), "UrModel::a2", "negative and finite", a2);
  check_parameter(positive(-a3), "UrModel::a3", "negative and finite", a3);
  check_parameter(positive(d4), "UrModel::d4", "positive and finite", d4);
  check_parameter(positive(d5), "UrModel::d5", "positive and finite", d5);
  check_parameter(std::isfinite(d6), "UrModel::d6", "finite", d6);
  limits.check();
}

std::array<Piece, 15> stretched_pieces(const UrModel& model, double shoulder_offset, double elbow_offset,
                                       double thickness) {
  const UrModel ur3;
  constexpr double upper = 0.1198, fore = 0.0275;  // the offsets of the UR3
  std::array<Piece, 15> pieces = ur3.pieces;
  for (Piece& piece : pieces) {
    const OrientedCylinder& c = piece.cylinder;
    const auto moved = [&](Eigen::Vector3d p) -> Eigen::Vector3d {
      const bool upper_arm = piece.part == Part::upper_arm, forearm = piece.part == Part::forearm;
      if (piece.part == Part::base) return {0.0, 0.0, p.z() <= 0.0 ? p.z() : model.d1 - thickness * (ur3.d1 - p.z())};
      if (!upper_arm && !forearm) return thickness * p;
      // Along the link, what is nearer to the far joint moves with that joint.
      const double length = upper_arm ? model.a2 : model.a3, old_length = upper_arm ? ur3.a2 : ur3.a3;
      const double x = p.x() < 0.5 * old_length ? length + thickness * (p.x() - old_length) : thickness * p.x();
      return {x, thickness * p.y(),
              upper_arm ? shoulder_offset + thickness * (p.z() - upper) : elbow_offset + thickness * (p.z() - fore)};
    };
    const Eigen::Vector3d half = 0.5 * c.height * c.axis;
    piece = make_piece(piece.part, moved(c.center - half), moved(c.center + half), thickness * c.radius);
  }
  return pieces;
}

const std::vector<UrModel>& ur_models() {
  static const JointLimits small = with_speeds(kPi, kPi, kTwoPi), middle = with_speeds(kPi, kPi, kPi),
                           large = with_speeds(kTwoPi / 3.0, kPi, kPi);
  // Lengths d1, a2, a3, d4, d5, d6; offsets of shoulder and elbow (physical_parameters.yaml of the maker's
  // description); thickness by the diameters of the joints in the maker's drawings, rounded up.
  static const std::vector<UrModel> models{
      UrModel{},
      member("ur3e", {0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921}, 0.12, 0.027, 1.05, small),
      member("ur5e", {0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996}, 0.138, 0.007, 1.45, middle),
      member("ur10e", {0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655}, 0.176, 0.039, 1.85, large),
  };
  return models;
}

const UrModel& ur_model(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::string known;
  for (const UrModel& model : ur_models()) {
    if (model.name == lower) return model;
    known += (known.empty() ? "" : ", ") + std::string(model.name);
  }
  throw InputError("no arm is called '" + std::string(name) + "'; known are " + known +
                   " (for another arm, give the pipeline a function `reach`)");
}

}  // namespace agrisee::arm
