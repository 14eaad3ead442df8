// SPDX-License-Identifier: BSD-3-Clause
// Which colors and labels a robot node takes together with a depth image.
#include "frame_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "catch.hpp"

using namespace agrisee;
using robot::ChannelParameters;
using Text = std::shared_ptr<const std::string>;
using Matcher = robot::FrameMatcher<int, Text>;

namespace {

Text text(const char* t) { return std::make_shared<const std::string>(t); }

ChannelParameters both() {
  ChannelParameters p;
  p.color = p.labels = true;
  return p;
}

}  // namespace

TEST_CASE("a depth image goes alone where nothing else is awaited") {
  Matcher matcher{ChannelParameters()};
  CHECK_FALSE(matcher.take());
  matcher.add_color(1.0, text("not asked for"));
  matcher.add_depth(1.0, 7);
  const auto match = matcher.take();
  REQUIRE(match);
  CHECK(match->depth == 7);
  CHECK(match->complete);
  CHECK_FALSE(match->color);
  CHECK_FALSE(matcher.take());
}

TEST_CASE("a depth image waits for the labels of its moment, that come late and not for every image") {
  Matcher matcher(both());
  for (int i = 0; i < 5; ++i) {
    matcher.add_depth(1.0 + 0.1 * i, i);
    matcher.add_color(1.0 + 0.1 * i + 0.004, text(std::to_string(i).c_str()));
    CHECK_FALSE(matcher.take());
  }
  matcher.add_labels(0.9, text("of the view before"));
  matcher.add_labels(1.25, text("of no image that came"));
  CHECK_FALSE(matcher.take());
  matcher.add_labels(1.3, text("labels"));
  const auto match = matcher.take();
  REQUIRE(match);
  CHECK(match->depth == 3);
  CHECK(*match->color == "3");
  CHECK(*match->labels == "labels");
  CHECK(match->complete);
  CHECK_FALSE(matcher.take());  // the others are gone with it
}

TEST_CASE("labels that come before their depth image are kept, the nearest one counts") {
  ChannelParameters parameters;
  parameters.labels = true;
  parameters.slop = 0.05;
  Matcher matcher(parameters);
  matcher.add_labels(1.00, text("far"));
  matcher.add_labels(1.03, text("near"));
  matcher.add_depth(1.04, 1);
  const auto match = matcher.take();
  REQUIRE(match);
  CHECK(*match->labels == "near");
}

TEST_CASE("a detector that is silent does not hold up a scan") {
  Matcher matcher(both());
  for (int i = 0; i < 10; ++i) {
    matcher.add_depth(5.0 + 0.1 * i, i);
    matcher.add_color(5.0 + 0.1 * i, text("color"));
    CHECK_FALSE(matcher.take());
  }
  matcher.add_depth(6.01, 10);
  matcher.add_color(6.01, text("the last"));
  const auto match = matcher.take();
  REQUIRE(match);
  CHECK(match->depth == 10);
  CHECK_FALSE(match->complete);
  CHECK(*match->color == "the last");
  CHECK_FALSE(match->labels);
}

TEST_CASE("late labels are awaited as long as the parameters say, however fast the camera is") {
  const double rate = GENERATE(30.0, 60.0, 90.0), wait = GENERATE(1.0, 3.0), late = GENERATE(0.5, 0.8, 1.2, 2.5);
  CAPTURE(rate, wait, late);
  ChannelParameters parameters = both();
  parameters.wait = wait;
  Matcher matcher(parameters);
  std::optional<Matcher::Match> match;
  double stamp = 0.0;
  for (int i = 0; !match; ++i) {
    stamp = i / rate;
    matcher.add_depth(stamp, i);
    matcher.add_color(stamp + 0.003, text(std::to_string(i).c_str()));
    const int labeled = i - static_cast<int>(std::lround(late * rate));
    if (labeled >= 0 && labeled % 6 == 0) matcher.add_labels(labeled / rate, text(std::to_string(labeled).c_str()));
    match = matcher.take();
    REQUIRE(stamp < 4.0);
  }
  CHECK(match->complete == (late < wait));
  CHECK(stamp == Approx(std::min(late, wait)).margin(0.35));
  REQUIRE(match->color);
  CHECK(*match->color == std::to_string(match->depth));
  if (match->complete) CHECK(*match->labels == *match->color);
}

TEST_CASE("a fast camera cannot fill the memory") {
  ChannelParameters parameters = both();
  parameters.wait = 1e6;
  robot::FrameMatcher<Text, Text> matcher(parameters);
  std::vector<std::weak_ptr<const std::string>> depths, colors;
  const auto alive = [](const auto& list) {
    return std::count_if(list.begin(), list.end(), [](const auto& image) { return !image.expired(); });
  };
  for (int i = 0; i < 2000; ++i) {
    const Text depth = text("depth"), color = text("color");
    depths.push_back(depth);
    colors.push_back(color);
    matcher.add_depth(0.02 * i, depth);
    matcher.add_color(0.02 * i, color);
    CHECK_FALSE(matcher.take());
  }
  CHECK(alive(depths) == 100);
  CHECK(alive(colors) <= 140);
  // Those that are kept are spread over the time.
  for (std::size_t from = 0; from < depths.size(); from += 100)
    CHECK(std::any_of(depths.begin() + std::ptrdiff_t(from), depths.begin() + std::ptrdiff_t(from) + 100,
                      [](const auto& image) { return !image.expired(); }));
}

TEST_CASE("a clock that is set back begins the wait anew") {
  Matcher matcher(both());
  matcher.add_depth(1000.0, 1);
  matcher.add_depth(5.0, 2);
  CHECK_FALSE(matcher.take());
  matcher.add_depth(6.0, 3);
  const auto match = matcher.take();
  REQUIRE(match);
  CHECK(match->depth == 3);
}

TEST_CASE("depth images of another view are forgotten, not what comes late for the next one") {
  Matcher matcher(both());
  matcher.add_depth(1.0, 1);
  matcher.add_labels(2.0, text("labels"));
  matcher.add_color(2.0, text("color"));
  matcher.forget_depths();
  matcher.add_color(1.0, text("old"));
  matcher.add_labels(1.0, text("old"));
  CHECK_FALSE(matcher.take());
  matcher.add_depth(2.0, 2);
  CHECK(matcher.take());
}

TEST_CASE("parameters of channels are checked") {
  ChannelParameters p;
  p.score = 1.5;
  CHECK_THROWS_WITH(p.check(), "channels.score must be from 0 to 1, got 1.5");
  p = {};
  p.wait = 0.0;
  CHECK_THROWS_AS(p.check(), ParameterError);
}
