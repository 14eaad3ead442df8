// SPDX-License-Identifier: BSD-3-Clause
// How the default planner chooses among views whose gains and times are known: gain for time, and refusals.
#include <agrisee/plan/gain_planner.hpp>

#include <numeric>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace {

/// A planner of a row of voxels whose candidates are the views of a script.
struct Game {
  Row row;
  Script script;
  std::unique_ptr<GainPlanner> planner;

  Game(int voxels, std::vector<std::optional<ReachableView>> views) : row(voxels) {
    script.views = std::move(views);
    row.parameters.candidates = static_cast<int>(script.views.size());
  }
  /// The view that the planner wants next, from joints `seconds` away from 0: its number in the script.
  int next(double seconds = 0.0) {
    if (!planner) planner = row.planner();
    const auto view = planner->next(row.scan.progress(), at_time(seconds), script.reach());
    gain = view ? view->gain / Row::kArea : 0.0;
    return script.which(view);
  }
  /// The candidates that the planner compared, by their gains in voxels.
  std::vector<int> ranking() const {
    std::vector<int> out;
    for (const ReachableView& v : planner->candidates()) out.push_back(static_cast<int>(v.gain / Row::kArea));
    return out;
  }
  double gain = 0.0;  // of the last view (voxels)
};

using Ranking = std::vector<int>;

}  // namespace

TEST_CASE("gain choice: without moves the view that shows the most wins") {
  Game game(12, {Row::view(0, 4), Row::view(2, 8), Row::view(5, 6)});
  CHECK(game.next() == 1);
  CHECK(game.gain == 8.0);
  CHECK(game.ranking() == Ranking{8, 6, 4});
}

TEST_CASE("gain choice: gain counts for the time that dwelling and moving take") {
  // In voxels a second: 8 / (1 + 3) = 2, 6 / (1 + 1) = 3, 4 / (1 + 0) = 4.
  Game game(12, {Row::view(0, 8, 3.0), Row::view(0, 6, 1.0), Row::view(0, 4, 0.0)});
  CHECK(game.next(0.0) == 2);
  CHECK(game.ranking() == Ranking{4, 6, 8});
  // From where the largest is: 8 / 1, 6 / 3 and 4 / 4.
  game.planner.reset();
  CHECK(game.next(3.0) == 0);
  CHECK(game.ranking() == Ranking{8, 6, 4});
  // With long dwelling, moves hardly count.
  game.planner.reset();
  game.row.parameters.dwell = 100.0;
  CHECK(game.next(0.0) == 0);
}

TEST_CASE("gain choice: the time is that of all joints together, whatever the arm says, else what the arm says") {
  Game game(12, {Row::view(0, 6, 0.0), Row::view(0, 3), Row::view(0, 2, 0.0)});
  *game.script.views[0]->joints << 0.0, 3.0 * kPi, 0.0, 0.0, -4.0 * kPi, 0.0;  // 5 s: 1 voxel a second
  CHECK(game.next() == 1);
  CHECK(game.ranking() == Ranking{3, 2, 6});
  game.planner.reset();
  game.script.views[0]->move_time = 0.0;
  game.script.views[1]->move_time = 1.0;  // 1.5 voxels a second
  game.script.views[2]->move_time = 9.0;
  CHECK(game.next() == 2);
  CHECK(game.ranking() == Ranking{2, 3, 6});
}

TEST_CASE("gain choice: without joints the time of a move is what the arm answered last") {
  Game game(12, {Row::view(0, 8), Row::view(0, 6), Row::view(0, 4)});
  game.script.views[0]->move_time = 3.0;  // 2 voxels a second
  game.script.views[1]->move_time = 1.0;  // 3
  CHECK(game.next(7.0) == 2);             // 4; the joints do not matter
  CHECK(game.ranking() == Ranking{4, 6, 8});
  game.planner->observe(game.row.scan.progress());
  game.script.views[0]->move_time = 0.0;
  CHECK(game.next() == 0);
  game.planner->refused();
  game.script.views[2]->move_time = 0.5;  // it was taken before: left out
  CHECK(game.next() == 1);
}

TEST_CASE("gain choice: a view that turns out to be far is offered again until it is refused") {
  // The eight best are asked for again, and turn out to be so far that the ninth is chosen; then it is far as well.
  std::vector<std::optional<ReachableView>> views(9, Row::view(0, 6));
  views.push_back(Row::view(0, 4));
  Game game(12, views);
  game.planner = game.row.planner();
  int asked = 0;
  const Reach slower = [&](const ViewRequest& r, const Joints& q) {
    auto view = game.script.reach()(r, q);
    if (view && ++asked > 10) view->move_time = 5.0;
    return view;
  };
  const auto ask = [&] { return game.planner->next(game.row.scan.progress(), Joints::Zero(), slower); };
  const auto view = ask(), again = ask();
  REQUIRE(view);
  REQUIRE(again);
  CHECK(view->gain == 6 * Row::kArea);
  CHECK(view->move_time == 5.0);
  CHECK(again->gain == view->gain);  // not the fourth part of the gain at once
  game.planner->refused();
  CHECK(ask()->gain == 4 * Row::kArea);
}

TEST_CASE(
    "gain choice: the eight best are asked for again, with six directions around each, and closer to the four best") {
  std::vector<std::optional<ReachableView>> views;
  for (int i = 0; i < 10; ++i) views.push_back(Row::view(0, i + 1));
  Game game(10, views);
  CHECK(game.next() == 9);
  std::vector<int> expected(10);
  std::iota(expected.begin(), expected.end(), 0);
  for (int best = 9; best >= 2; --best) {
    expected.push_back(best);
    expected.insert(expected.end(), 6, -1);
  }
  expected.insert(expected.end(), 4 * 6, -1);
  expected.push_back(9);
  REQUIRE(game.script.asked == expected);
  // Around the candidate by half the spacing of ten directions, which stand for 4 pi / 10 each.
  const double step = 0.5 * std::sqrt(0.4 * kPi);
  const auto expect_around = [&](std::size_t middle_at, std::size_t from, double apart) {
    const ViewRequest& middle = game.script.requests[middle_at];
    for (std::size_t k = 0; k < 6; ++k) {
      const ViewRequest &r = game.script.requests[from + k], &other = game.script.requests[from + (k + 1) % 6];
      CHECK(r.direction.norm() == Approx(1.0));
      CHECK(r.direction.dot(middle.direction) == Approx(1.0 / std::sqrt(1.0 + apart * apart)));
      CHECK(r.direction.dot(other.direction) == Approx((1.0 + 0.5 * apart * apart) / (1.0 + apart * apart)));
      CHECK(r.target == middle.target);
      CHECK(r.distance == middle.distance);
    }
  };
  for (std::size_t i = 0; i < 8; ++i) expect_around(10 + 7 * i, 11 + 7 * i, step);
  for (std::size_t i = 0; i < 4; ++i) expect_around(10 + 7 * i, 66 + 6 * i, 0.5 * step);
}

TEST_CASE("gain choice: a better view beside a candidate is taken, and the candidate once that is refused") {
  Game game(12, {Row::view(0, 4)});
  game.script.other = Row::view(0, 8, 0.5);
  CHECK(game.next() == -1);
  CHECK(game.gain == 8.0);
  Ranking expected(6 + 4 * 6, 8);  // the closer ones are beside the best of the first six
  expected.push_back(4);
  CHECK(game.ranking() == expected);
  int beside = 0;
  while (beside < 100 && game.next() == -1) {
    game.planner->refused();
    ++beside;
  }
  CHECK(beside > 6);
  CHECK(beside <= 6 + 4 * 6);
  CHECK(game.next() == 0);
  game.planner->refused();
  CHECK(game.next() == -1);
  CHECK(game.gain == 0.0);
  CHECK(game.planner->stop_reason() == StopReason::no_reachable_view);
}

TEST_CASE("gain choice: the best are rated anew as the arm reaches them from its present joints") {
  Game game(12, {Row::view(0, 8, 7.0), Row::view(0, 6, 0.0)});
  CHECK(game.next() == 1);
  game.planner->observe(game.row.scan.progress());
  game.script.views[0] = Row::view(0, 8, 0.0);  // now the arm has found a better way
  CHECK(game.next() == 0);
  CHECK(game.ranking() == Ranking{8});  // without the one that was just taken
}

TEST_CASE("gain choice: the chosen view is the one the arm answered last") {
  Game game(12, {Row::view(0, 8, 1.0), Row::view(0, 6, 1.0)});
  game.planner = game.row.planner();
  int asked = 0;
  const Reach counting = [&](const ViewRequest& r, const Joints& q) {
    auto view = game.script.reach()(r, q);
    if (view) view->move_time = ++asked;
    return view;
  };
  const auto view = game.planner->next(game.row.scan.progress(), at_time(0.0), counting);
  REQUIRE(view);
  CHECK(asked == 5);  // 2 candidates, twice, and the best once more
  CHECK(view->move_time == 5.0);
  CHECK(view->gain == 8 * Row::kArea);
  CHECK(game.planner->candidates()[0].move_time == 5.0);
}

TEST_CASE("gain choice: a view that the arm can no longer take is not returned") {
  // The planner asks for the three candidates, then for each again with its surroundings, at last for the best.
  const auto game_of_three = [] { return Game(12, {Row::view(0, 8), Row::view(0, 6), Row::view(0, 4)}); };
  const auto losing = [](Game& game, int first) {  // from the time it is asked for the n-th time the arm takes no 8
    return [&game, first, asked = 0](const ViewRequest& r, const Joints& q) mutable {
      auto view = game.script.reach()(r, q);
      return ++asked >= first && game.script.which(view) == 0 ? std::nullopt : view;
    };
  };
  for (const int first : {4, 25}) {
    Game game = game_of_three();
    game.planner = game.row.planner();
    const Reach reach = losing(game, first);
    for (int i = 0; i < 2; ++i)
      CHECK(game.script.which(game.planner->next(game.row.scan.progress(), at_time(0.0), reach)) == 1);
    CHECK(game.ranking() == Ranking{6, 4});
    game.planner->refused();
    CHECK(game.script.which(game.planner->next(game.row.scan.progress(), at_time(0.0), reach)) == 2);
  }
  Game game = game_of_three();
  CHECK(game.next() == 0);
  game.planner->refused();
  game.script.views[1].reset();
  CHECK(game.next() == 2);
}

TEST_CASE("gain choice: when the arm can take none of the views that were worth taking, that ends the scan") {
  Game game(12, {Row::view(0, 8), Row::view(0, 6), Row::view(0, 1)});
  game.row.parameters.min_gain = 3.0 * Row::kArea / Row::one_fruit();
  const auto expect_none = [&](double seconds) {
    CHECK(game.next(seconds) == -1);
    CHECK(game.planner->stop_reason() == StopReason::no_reachable_view);
    CHECK(game.ranking().empty());
  };
  CHECK(game.next() == 0);
  const auto views = game.script.views;
  game.script.views.assign(3, std::nullopt);
  for (int i = 0; i < 2; ++i) expect_none(0.0);
  const std::size_t asked = game.script.asked.size();
  expect_none(0.0);
  CHECK(game.script.asked.size() == asked);
  game.script.views = views;  // from other joints it is asked for them again
  CHECK(game.next(1.0) == 0);
  game.script.views[0].reset();
  game.script.views[1].reset();
  game.planner->observe(game.row.scan.progress());
  expect_none(1.0);  // the poor one alone is no reason to tell that no view is worth taking
}

TEST_CASE("gain choice: views that were lost in a cancelled call are asked for again") {
  Game game(12, {Row::view(0, 8), Row::view(0, 6), Row::view(0, 4)});
  CHECK(game.next() == 0);
  game.planner->refused();
  const auto six = game.script.views[1];
  game.script.views[1].reset();
  CancelledAt cancelled;
  const Reach reach = [&](const ViewRequest& r, const Joints& q) {
    const auto view = game.script.reach()(r, q);
    throw_if_cancelled();
    return view;
  };
  REQUIRE(cancelled.next(*game.planner, game.row.scan.progress(), at_time(0.0), reach, 2));
  game.script.views[1] = six;
  CHECK(game.next() == 1);
}

TEST_CASE("gain choice: a refused view is not returned again until the next view was taken") {
  Game game(12, {Row::view(0, 4), Row::view(0, 8), Row::view(0, 6)});
  for (const int expected : {1, 2, 0, -1, -1}) {
    CHECK(game.next() == expected);
    if (expected >= 0) game.planner->refused();
  }
  CHECK(game.planner->stop_reason() == StopReason::no_reachable_view);
  CHECK(game.ranking().empty());
  game.planner->observe(game.row.scan.progress());
  CHECK(game.next() == 1);
  CHECK(game.next() == 1);  // asked twice, the same answer
  CHECK(game.ranking() == Ranking{8, 6, 4});
}

TEST_CASE("gain choice: when all are refused, the surroundings of those that were not among the eight best are tried") {
  std::vector<std::optional<ReachableView>> views(9, Row::view(0, 8));
  views[4] = Row::view(0, 2);  // less than a view is worth
  Game game(12, views);
  game.row.parameters.min_gain = 3.0 * Row::kArea / Row::one_fruit();
  game.planner = game.row.planner();
  double distance = 0.0;  // of the poor one: candidates differ in it, and those around have that of their middle
  const Reach reach = [&](const ViewRequest& r, const Joints& q) {
    game.script.other.reset();
    if (r.direction == spread_directions(9)[4]) distance = r.distance;
    if (r.distance == distance) game.script.other = Row::view(0, 6);
    return game.script.reach()(r, q);
  };
  const auto ask = [&](double seconds) {
    const auto view = game.planner->next(game.row.scan.progress(), at_time(seconds), reach);
    return view ? static_cast<int>(view->gain / Row::kArea) : 0;
  };
  for (int i = 0; i < 8; ++i) {
    CHECK(ask(0.0) == 8);
    game.planner->refused();
  }
  int around = 0;
  while (around < 100 && ask(0.0) == 6) {
    CHECK(ask(0.0) == 6);
    game.planner->refused();
    ++around;
  }
  CHECK(around == 6 + 4 * 6 + 6);  // beside it, closer to four of these, and closer to it
  for (int i = 0; i < 2; ++i) {
    CHECK(ask(0.0) == 0);
    CHECK(game.planner->stop_reason() == StopReason::no_reachable_view);
  }
  // Where it has stopped, the arm is not asked again; from other joints it is.
  const std::size_t asked = game.script.asked.size();
  CHECK(ask(0.0) == 0);
  CHECK(game.script.asked.size() == asked);
  CHECK(ask(1.0) == 0);
  CHECK(game.script.asked.size() > asked);
}

TEST_CASE("gain choice: the view just taken is not taken again at once, but later") {
  Game game(12, {Row::view(0, 4), Row::view(0, 8), Row::view(0, 6)});
  for (const int expected : {1, 2, 1, 2}) {
    CHECK(game.next() == expected);
    game.planner->observe(game.row.scan.progress());  // nothing new: all views promise what they did
  }
  CHECK(game.next() == 1);
  CHECK(game.ranking() == Ranking{8, 4});
}

TEST_CASE("gain choice: after a refusal the others are compared from where the arm is") {
  Game game(12, {Row::view(0, 8, 0.0), Row::view(0, 6, 0.0), Row::view(0, 4, 5.0)});
  CHECK(game.next(0.0) == 0);
  CHECK(game.ranking() == Ranking{8, 6, 4});
  game.planner->refused();
  CHECK(game.next(5.0) == 2);  // 4 / 1 against 6 / 6
  CHECK(game.ranking() == Ranking{4, 6});
  CHECK(game.next(0.0) == 1);
}

TEST_CASE("gain choice: with a view, others within a centimetre of its target and distance are refused") {
  // Two of 100 000 directions that differ by less than 0.8 degrees, and one that differs by more.
  const auto directions = spread_directions(100000);
  const std::size_t a = 50000;
  std::size_t b = 0, c = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double cosine = directions[i].dot(directions[a]);
    if (i != a && cosine > 0.99993) b = i;
    if (cosine < 0.99985 && cosine > 0.9998) c = i;
  }
  REQUIRE(b > 0);
  REQUIRE(c > 0);
  const auto part = [](double x) { return x - std::floor(x); };
  const auto distance_apart = [&](double step) { return std::abs(part(double(a) * step) - part(double(b) * step)); };
  const auto second = [&](double targets, double distances) {  // that the planner returns, with their differences (m)
    Row row(12);
    row.scan.add_point({targets / distance_apart(0.8566748838545029), 1.0, 0.0});
    row.parameters.candidates = 100000;
    row.parameters.spread = 1.0;
    row.parameters.distance_min = row.parameters.distance = 0.3;
    row.parameters.distance_max = 0.3 + distances / distance_apart(0.5385972572236101);
    const auto planner = row.planner();
    std::array<ViewRequest, 3> requests;
    const Reach reach = [&](const ViewRequest& r, const Joints&) -> std::optional<ReachableView> {
      const int count = r.direction == directions[a] ? 8 : r.direction == directions[b] ? 6 : 4;
      if (count == 4 && r.direction != directions[c]) return std::nullopt;
      requests[static_cast<std::size_t>(8 - count) / 2] = r;
      return Row::view(0, count);
    };
    CHECK(planner->next(row.scan.progress(), Joints::Zero(), reach)->gain == 8 * Row::kArea);
    CHECK((requests[0].target - requests[1].target).norm() == Approx(targets).margin(1e-6));
    CHECK(std::abs(requests[0].distance - requests[1].distance) == Approx(distances).margin(1e-6));
    planner->refused();
    return planner->next(row.scan.progress(), Joints::Zero(), reach)->gain / Row::kArea;
  };
  CHECK(second(0.0, 0.0) == 4.0);
  CHECK(second(0.0099, 0.0099) == 4.0);
  CHECK(second(0.0101, 0.0) == 6.0);
  CHECK(second(0.0, 0.0101) == 6.0);
}

TEST_CASE("gain choice: the same as by comparing all views, in random games") {
  struct Choice {
    int first, count;
    std::optional<double> at;
  };
  Rng rng(9);
  int not_the_most = 0;
  for (int round = 0; round < 150; ++round) {
    std::vector<Choice> choices;
    std::vector<std::optional<ReachableView>> views;
    for (int i = 0; i < 8; ++i) {
      const int count = 1 + static_cast<int>(rng.below(8));
      choices.push_back(
          {static_cast<int>(rng.below(static_cast<std::uint64_t>(24 - count))), count, rng.uniform(-2, 2)});
      if (rng.below(8) == 0) choices.back().at.reset();
      views.push_back(Row::view(choices.back().first, count, choices.back().at));
      views.back()->move_time = 0.25 * i;
    }
    Game game(24, views);
    game.row.parameters.min_gain = 1.5 * Row::kArea / Row::one_fruit();
    const double now = rng.uniform(-2, 2);
    double most = 0.0;
    std::size_t best = 0;
    int largest = 0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const Choice& c = choices[i];
      const double move = c.at ? std::abs(*c.at - now) : views[i]->move_time;
      const double score = c.count / (1.0 + move);
      if (c.count >= 2 && score > most) most = score, best = i;
      largest = std::max(largest, c.count);
    }
    not_the_most += choices[best].count < largest;
    const auto view = [&] {
      game.planner = game.row.planner();
      return game.planner->next(game.row.scan.progress(), at_time(now), game.script.reach());
    }();
    INFO("round " << round);
    REQUIRE(view);
    CHECK(view->world_T_optical.matrix() ==
          Row::view(choices[best].first, choices[best].count).world_T_optical.matrix());
  }
  CHECK(not_the_most > 20);
}
