// SPDX-License-Identifier: BSD-3-Clause
// Brings a depth image together with the colors and labels of the same moment, without ROS.
#pragma once

#include <agrisee/core/parameter_range.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

namespace agrisee::robot {

/// Which images are expected with a depth image.
struct ChannelParameters {
  bool color = false;   ///< take colors
  bool labels = false;  ///< take a detector's label images
  double score = 1.0;   ///< of every label: how far the detector is to be believed, 0..1
  double slop = 0.01;   ///< images whose stamps differ by no more belong together (s)
  double wait = 1.0;  ///< a depth image goes without the others if they are missing when one this much later comes (s)

  /// @throws FieldError for the first field that is out of its range, e.g. `channels.score`
  void check() const { check_fields(*this, "channels."); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("color", p.color);
    f("labels", p.labels);
    f("score", p.score, Range::between(0.0, 1.0));
    f("slop", p.slop, Range::not_negative());
    f("wait", p.wait, Range::positive());
  }
};

/// Depth images wait for the images that belong to them: a detector answers late, and not for every one. Of more than
/// 100 depth images those closest to others are dropped, whose labels are missed then; the wait is never shortened.
/// Depth is what the caller keeps of a depth image, Image a pointer to another image.
template <typename Depth, typename Image>
class FrameMatcher {
 public:
  /// A depth image and what belongs to it; an image that is not awaited, or did not come, is null.
  struct Match {
    Depth depth;
    Image color = nullptr, labels = nullptr;
    bool complete = false;  ///< whether everything came that is awaited
  };

  explicit FrameMatcher(const ChannelParameters& parameters) : parameters_(parameters) {}

  /// Stamps are in seconds.
  void add_depth(double stamp, Depth depth) {
    if (!depths_.empty() && stamp < depths_.front().first) depths_.clear();  // the clock was set back
    depths_.emplace_back(stamp, std::move(depth));
    if (depths_.size() > kMostDepths) depths_.erase(closest_to_others());
  }
  void add_color(double stamp, Image image) { add(colors_, stamp, std::move(image)); }
  void add_labels(double stamp, Image image) { add(labels_, stamp, std::move(image)); }

  /// The first depth image for which everything came; the newest one, without what is missing, once the first has
  /// waited too long. No depth image is kept then.
  std::optional<Match> take() {
    if (depths_.empty()) return std::nullopt;
    for (const auto& [stamp, depth] : depths_) {
      Match match = matched(stamp, depth);
      if (!match.complete) continue;
      depths_.clear();
      return match;
    }
    if (depths_.back().first - depths_.front().first < parameters_.wait) return std::nullopt;
    Match match = matched(depths_.back().first, depths_.back().second);
    depths_.clear();
    return match;
  }

  /// Forget the depth images; they were of another view.
  void forget_depths() { depths_.clear(); }

 private:
  static constexpr std::size_t kMostDepths = 100;
  static constexpr std::size_t kMostOthers = 40;  // images of a kind that belong to no waiting depth image
  template <typename T>
  using Stamped = std::deque<std::pair<double, T>>;

  /// Of the depth images between the first and the last the one whose neighbors are closest to each other.
  typename Stamped<Depth>::iterator closest_to_others() {
    auto best = depths_.begin() + 1;
    const auto gap = [](auto at) { return (at + 1)->first - (at - 1)->first; };
    for (auto at = best; at + 1 != depths_.end(); ++at)
      if (gap(at) < gap(best)) best = at;
    return best;
  }

  void add(Stamped<Image>& list, double stamp, Image image) {
    list.emplace_back(stamp, std::move(image));
    const auto spare = [&](const std::pair<double, Image>& entry) {
      return std::none_of(depths_.begin(), depths_.end(), [&](const std::pair<double, Depth>& depth) {
        return std::abs(depth.first - entry.first) <= parameters_.slop;
      });
    };
    if (list.size() <= kMostOthers || std::size_t(std::count_if(list.begin(), list.end(), spare)) <= kMostOthers)
      return;
    list.erase(std::find_if(list.begin(), list.end(), spare));
  }

  Match matched(double stamp, const Depth& depth) const {
    Match match{depth, nullptr, nullptr, false};
    if (parameters_.color) match.color = nearest(colors_, stamp);
    if (parameters_.labels) match.labels = nearest(labels_, stamp);
    match.complete = (!parameters_.color || match.color) && (!parameters_.labels || match.labels);
    return match;
  }

  Image nearest(const Stamped<Image>& list, double stamp) const {
    const std::pair<double, Image>* best = nullptr;
    for (const auto& entry : list)
      if (!best || std::abs(entry.first - stamp) < std::abs(best->first - stamp)) best = &entry;
    return best && std::abs(best->first - stamp) <= parameters_.slop ? best->second : nullptr;
  }

  ChannelParameters parameters_;
  Stamped<Depth> depths_;
  Stamped<Image> colors_, labels_;
};

}  // namespace agrisee::robot
