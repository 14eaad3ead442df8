// SPDX-License-Identifier: BSD-3-Clause
// Answers of an arm's own approach function are checked.
#include <agrisee/pick/approach.hpp>

#include <limits>

#include "catch.hpp"
#include "support/says.hpp"

using namespace agrisee;
using namespace agrisee::pick;
using Eigen::Vector3d;

namespace approach_test {

TEST_CASE("approach: answers of another arm are checked") {
  const Vector3d direction = Vector3d(0.2, 1.0, -0.3).normalized(), start(0.1, 0.4, 0.2);
  const std::vector<KeepOut> none;
  const std::vector<OrientedEllipsoid> alone;
  const ApproachRequest request{direction, start, start + 0.12 * direction, none, alone};
  // The answer to the request, changed.
  const auto answer = [&](auto&& change) {
    const ReachApproach approach = checked([&](const ApproachRequest& r, const Joints&) {
      ApproachAnswer out{ReachableApproach{look_along(r.start, r.direction, 0.7), Joints(Joints::Zero())},
                         PickingReason::reachable};
      change(out);
      return out;
    });
    return approach(request, Joints::Zero());
  };
  const auto pose = [&](auto&& change) {
    return answer([&](ApproachAnswer& a) { change(a.reached->world_T_pre_grasp); });
  };
  const auto turned = [&](double degrees) {
    return pose([&](Pose& p) { p.rotate(Eigen::AngleAxisd(deg(degrees), Vector3d(0.6, 0.8, 0.0))); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();

  const ApproachAnswer good = answer([](ApproachAnswer&) {});
  REQUIRE(good.reached);
  CHECK(good.reached->world_T_pre_grasp.matrix() == look_along(start, direction, 0.7).matrix());
  CHECK(answer([](ApproachAnswer& a) { a.reached->joints.reset(); }).reached);
  CHECK(turned(0.9).reached);
  CHECK(pose([](Pose& p) { p.translation().z() += 0.0019; }).reached);
  const auto refused = answer([](ApproachAnswer& a) { a = {std::nullopt, PickingReason::arm_meets_fruit}; });
  CHECK_FALSE(refused.reached);
  CHECK(refused.reason == PickingReason::arm_meets_fruit);
  CHECK_FALSE(checked(ReachApproach{}));

  const std::string rigid = "approach: world_T_pre_grasp of its answer is not a rigid pose";
  CHECK_THROWS_WITH(pose([&](Pose& p) { p.translation().x() = nan; }), rigid);
  CHECK_THROWS_WITH(pose([](Pose& p) { p.linear().col(0) *= -1.0; }), rigid);
  CHECK_THROWS_WITH(pose([](Pose& p) { p = Pose::Identity(); }),
                    test::says("world_T_pre_grasp of its answer is 0.458 m from the start of the request"));
  CHECK_THROWS_WITH(pose([](Pose& p) { p.translation().z() += 0.0021; }), test::says("from the start of the request"));
  const std::string axis = "degrees beside the direction of the request";
  CHECK_THROWS_WITH(turned(1.1), test::says("is 1.1 " + axis));
  CHECK_THROWS_WITH(turned(180.0), test::says("is 180 " + axis));
  CHECK_THROWS_WITH(answer([&](ApproachAnswer& a) { (*a.reached->joints)[2] = nan; }),
                    "approach: the joints of its answer are not finite");
  CHECK_THROWS_WITH(answer([](ApproachAnswer& a) { a.reason = PickingReason::out_of_reach; }),
                    "approach: its answer is `reached`, but has the reason out_of_reach instead of reachable");
  CHECK_THROWS_WITH(answer([](ApproachAnswer& a) { a.reached.reset(); }),
                    "approach: its answer is not `reached`, but has the reason reachable");
}

}  // namespace approach_test
