// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The arms of Universal Robots' family, as data: lengths, limits and the solids of their links. All have the same
/// kinematic structure. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/geometry/overlap.hpp>

#include <array>
#include <string_view>
#include <vector>

namespace agrisee::arm {

/// The bodies that may collide. The six links are in the order of LinkFrames.
enum class Part { shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3, base, sensor };

/// The name of a part, as messages use it.
std::string_view to_string(Part part);

/// One of the solids that make up a part: a flat-ended cylinder and the capsule that encloses it.
struct Piece {
  Part part = Part::shoulder;  ///< the part to which it belongs
  OrientedCylinder cylinder;   ///< in the frame of the part, or in world
  Capsule capsule;             ///< encloses the cylinder; in the same frame
};

/// Makes the piece with a cylinder of this radius (m) from a to b (m).
Piece make_piece(Part part, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius);

/// The pieces of the UR3's links from the shoulder to wrist 3 in their link frames, then that of the base in base_link,
/// without the connector.
const std::array<Piece, 15>& ur3_pieces();

/// One arm of the family. The defaults are those of the UR3. Lengths (m) are Denavit-Hartenberg parameters as the maker
/// publishes them ("DH parameters for calculations of kinematics and dynamics", Universal Robots' support pages).
struct UrModel {
  std::string_view name = "ur3";                ///< as in scene files: lower case, without a space
  double d1 = 0.1519;                           ///< from the base to the shoulder, along the axis of joint 1 (m)
  double a2 = -0.24365;                         ///< upper arm (m), negative
  double a3 = -0.21325;                         ///< forearm (m), negative
  double d4 = 0.11235;                          ///< wrist 1, along its joint axis (m), positive
  double d5 = 0.08535;                          ///< wrist 2 (m), positive
  double d6 = 0.0819;                           ///< from wrist 3 to tool0 (m)
  std::array<Piece, 15> pieces = ur3_pieces();  ///< solids of links and base for collision tests, as ur3_pieces
  JointLimits limits;                           ///< of joint angles and speeds

  /// The closed form of the inverse kinematics needs links of these signs; d1 and d6 may have either.
  /// @throws ParameterError with the name of the length or limit that is out of range
  void check() const;
};

/// The solids of a model whose links are longer and thicker than those of the UR3: its cylinders, `thickness` times as
/// wide and stretched to the lengths in `model`. They are not fitted to the maker's meshes as those of the UR3 are;
/// choose the thickness so that the drawings of the arm fit in.
/// @param shoulder_offset from the base's axis to the upper arm's tube, along the axis of joint 2 (m)
/// @param elbow_offset from the base's axis to the forearm's tube, along the axis of joint 2 (m)
std::array<Piece, 15> stretched_pieces(const UrModel& model, double shoulder_offset, double elbow_offset,
                                       double thickness);

/// All models: ur3, ur3e, ur5e, ur10e. Speeds are the maker's maxima: 180 deg/s, but 120 for base and
/// shoulder of a UR10e, and 360 for the wrists of a UR3 and UR3e. Angles are +-360 degrees, but +-180 for the
/// elbow, beyond which the forearm would hit the upper arm.
const std::vector<UrModel>& ur_models();

/// The model of this name, in small or capital letters.
/// @throws InputError with the known names if there is none
const UrModel& ur_model(std::string_view name);

}  // namespace agrisee::arm
