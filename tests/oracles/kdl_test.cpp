// SPDX-License-Identifier: BSD-3-Clause
// The UR3's kinematics against Orocos KDL, whose chain is built from the frames of the published description.
#include <agrisee/arm/ur.hpp>
#include <agrisee/core/random.hpp>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// base_link to tool0: a fixed turn by pi, then each joint about z of a frame placed by xyz and rpy.
KDL::Chain ur3_chain() {
  const double half = 1.570796326794897, pi = 3.141592653589793;
  const auto frame = [](double x, double y, double z, double roll, double pitch, double yaw) {
    return KDL::Frame(KDL::Rotation::RPY(roll, pitch, yaw), KDL::Vector(x, y, z));
  };
  const KDL::Frame placed[6] = {frame(0, 0, 0.1519, 0, 0, 0),      frame(0, 0, 0, half, 0, 0),
                                frame(-0.24365, 0, 0, 0, 0, 0),    frame(-0.21325, 0, 0.11235, 0, 0, 0),
                                frame(0, -0.08535, 0, half, 0, 0), frame(0, 0.0819, 0, half, pi, pi)};
  KDL::Chain chain;
  KDL::Frame before = frame(0, 0, 0, 0, 0, pi);
  for (const KDL::Frame& f : placed) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), before * f));
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ)));
    before = KDL::Frame::Identity();
  }
  return chain;
}

}  // namespace

TEST_CASE("forward kinematics, link frames and Jacobian equal KDL's on 10,000 postures") {
  const KDL::Chain chain = ur3_chain();
  REQUIRE(chain.getNrOfJoints() == 6);
  KDL::ChainFkSolverPos_recursive fk(chain);
  KDL::ChainJntToJacSolver jac(chain);
  Rng rng(1);
  for (int i = 0; i < 10000; ++i) {
    Joints q;
    KDL::JntArray kdl_q(6);
    for (int j = 0; j < 6; ++j) kdl_q(static_cast<unsigned>(j)) = q[j] = rng.uniform(-kTwoPi, kTwoPi);
    const arm::LinkFrames frames = arm::link_frames(q);
    for (int link = 0; link < 6; ++link) {
      KDL::Frame expected;
      REQUIRE(fk.JntToCart(kdl_q, expected, 2 * (link + 1)) >= 0);
      const Pose& found = frames[static_cast<std::size_t>(link)];
      double worst = 0.0;
      for (int r = 0; r < 3; ++r) {
        worst = std::max(worst, std::abs(found.translation()[r] - expected.p(r)));
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(found.linear()(r, c) - expected.M(r, c)));
      }
      REQUIRE(worst < 1e-9);
    }
    REQUIRE(arm::forward(q).matrix() == frames[5].matrix());
    KDL::Jacobian expected(6);
    REQUIRE(jac.JntToJac(kdl_q, expected) >= 0);
    REQUIRE((arm::jacobian(q) - expected.data).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("KDL reaches the pose by every inverse solution") {
  const KDL::Chain chain = ur3_chain();
  KDL::ChainFkSolverPos_recursive fk(chain);
  Rng rng(2);
  for (int i = 0; i < 2000; ++i) {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = rng.uniform(-kPi, kPi);
    const Pose pose = arm::forward(q);
    const auto solutions = arm::inverse(pose);
    REQUIRE_FALSE(solutions.empty());
    for (const Joints& s : solutions) {
      KDL::JntArray kdl_q(6);
      for (int j = 0; j < 6; ++j) kdl_q(static_cast<unsigned>(j)) = s[j];
      KDL::Frame reached;
      REQUIRE(fk.JntToCart(kdl_q, reached) >= 0);
      for (int r = 0; r < 3; ++r) {
        REQUIRE(std::abs(reached.p(r) - pose.translation()[r]) < 1e-9);
        for (int c = 0; c < 3; ++c) REQUIRE(std::abs(reached.M(r, c) - pose.linear()(r, c)) < 1e-9);
      }
    }
  }
}
