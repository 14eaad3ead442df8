// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The competition of bodies for the points of one cloud; bodies.hpp says how it is held. Metres.
#pragma once

#include <agrisee/cloud/alike_sizes.hpp>
#include <agrisee/cloud/body_counts.hpp>
#include <agrisee/cloud/body_evidence.hpp>
#include <agrisee/cloud/body_size.hpp>
#include <agrisee/cloud/body_verdict.hpp>
#include <agrisee/cloud/compare_bodies.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/found_body.hpp>
#include <agrisee/cloud/free_points.hpp>
#include <agrisee/cloud/fruit_probability.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/log_odds.hpp>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace agrisee {

namespace detail {

/// The competition for the points of one cloud; see find_bodies.
template <typename S>
class Competition {
 public:
  Competition(const PointCloud<S>& cloud, const Grid<S>& grid, const BodyParameters& parameters,
              const BodyEvidence& evidence)
      : parameters_(parameters), evidence_(evidence), free_(cloud, grid, parameters) {}

  /// Fit and judge the candidates. Those that score enough enter the competition.
  void enter(const std::vector<BodyCandidate>& candidates) {
    std::vector<Ellipsoid> known;  // where proposals ended up; many end up at the same place
    std::vector<Outgrown> outgrown;
    for (const BodyCandidate& c : candidates) {
      throw_if_cancelled();
      if (!parameters_.plausible(c.body.mean_radius())) {
        ++(counts_.*wrong_size(c.body.mean_radius(), parameters_));
        continue;
      }
      const auto fit = c.fit ? c.fit : fitted(c, known);
      if (!fit) continue;
      Entry e{*fit, &c.found_by, {}, 0.0, true, c.mask_log_odds, 0.0};
      e.prior = prior_of(e.fit.body);
      if (e.mask_log_odds) prefer_points(e);
      if (std::size_t BodyCounts::*const fault = assess(e)) {
        ++(counts_.*(c.doubt ? c.doubt : fault));
        continue;
      }
      Outgrown* const wider = outgrow(e, outgrown);
      if (!wider || wider->entry->confidence < e.confidence) keep(std::move(e));
      if (wider && !std::exchange(wider->entered, true)) keep(*wider->entry);
    }
  }

  /// Take the best body again and again until none is left. @param found receives the bodies taken, best first
  void decide(std::vector<FoundBody>& found) {
    while (Entry* best = best_entry()) {
      best->alive = false;
      if (clashes(best->fit.body, found)) {
        ++counts_.overlapping;
        continue;
      }
      ++counts_.taken;
      found.push_back({best->fit, *best->found_by, best->verdict.coverage, best->confidence,
                       best->mask_log_odds.has_value(), best->prior});
      free_.take(best->fit.body);
      judge_anew(best->fit.body);
    }
  }

  /// Keep the entries as they are, for decide_by_size().
  void remember() { entered_ = entries_; }

  /// Hold the competition once more, now that the sizes of the fruit are known.
  /// @param found what was found; receives what is found now
  void decide_by_size(std::vector<FoundBody>& found) {
    sizes_ = sizes_of(found);
    found.clear();
    counts_.taken = counts_.overlapping = 0;
    free_.release();
    entries_ = entered_;
    for (Entry& e : entries_) {
      throw_if_cancelled();
      e.prior = prior_of(e.fit.body);
      // The verdict of when nothing was taken still holds.
      if (std::size_t BodyCounts::*const fault = rate(e)) ++(counts_.*fault);
    }
    decide(found);
    constexpr double kLikely = 0.5;                                 // a fruit, rather than not
    const std::vector<KnownSize> sizes = sizes_of(found, kLikely);  // for the last fit of each
    for (FoundBody& f : found) f.fit.size_prior = size_prior(sizes, f.fit.body);
  }

  /// Let the masks that no body explains propose bodies for what is left. @param found receives those that are taken
  void fill_gaps(std::vector<FoundBody>& found) {
    std::vector<Ellipsoid> known;
    for (const FoundBody& f : found) known.push_back(f.fit.body);
    std::vector<BodyCandidate> candidates;
    for (const MaskBody& m : evidence_.masks.remaining(known))
      candidates.push_back({m.fit.body, "mask", nullptr, m.fit, m.log_odds});
    if (candidates.empty()) return;
    enter(candidates);
    decide(found);
  }

  /// Count the bodies that are left when all is decided.
  void close() {
    for (const Entry& e : entries_) counts_.doubtful += e.alive;
  }

  /// What became of the candidates so far.
  const BodyCounts& counts() const { return counts_; }

 private:
  /// An entry with less than this share of the required confidence does not compete. Those above it may gain confidence
  /// later: points that a better body takes are no longer clutter around them.
  static constexpr double kHopeless = 0.2;

  struct Entry {
    EllipsoidFit fit;
    const std::string* found_by;
    Verdict verdict;
    double confidence = 0.0;
    bool alive = true;
    std::optional<double> mask_log_odds = {};  // its fit is that of an outline, which the points do not change
    double prior = 0.0;                        // log-odds by the masks
  };

  /// Where entries grew to with a wide gate, roughly, and the entry that a better fit made of it; empty if it may not
  /// win.
  struct Outgrown {
    Ellipsoid place;
    std::optional<Entry> entry;
    bool entered = false;  // into the competition
  };

  /// The sizes of the bodies with at least some confidence.
  static std::vector<KnownSize> sizes_of(const std::vector<FoundBody>& found, double least = 0.0) {
    std::vector<KnownSize> sizes;
    for (const FoundBody& f : found)
      if (f.confidence >= least) sizes.push_back({f.fit.body, f.confidence});
    return sizes;
  }

  /// Log-odds against a body that masks of several views proposed, from sight lines through it, points inside it, and
  /// points on it that are not round. Those of a single view were weighed when the body was proposed.
  double against_masks(const Ellipsoid& body, const Verdict& v) const {
    constexpr double kThrough = 25.0, kUnsure = 0.02, kInside = 10.0, kFlat = 20.0, kFewPoints = 10.0;
    if (!evidence_.masks.remaining) return 0.0;
    const double through = evidence_.seen_through ? evidence_.seen_through(body) : 0.0;
    const double n = static_cast<double>(v.support);
    return kThrough * std::max(0.0, through - kUnsure) + kInside * v.inside +
           kFlat * v.flatness() * n / (n + kFewPoints);
  }

  /// Log-odds of a body by the masks and by the sizes of the other fruit.
  double prior_of(const Ellipsoid& body) const {
    const double by_size =
        sizes_.empty() ? 0.0 : alike_log_odds(sizes_, body, parameters_.radius_min, parameters_.radius_max);
    return (evidence_.masks.log_odds ? evidence_.masks.log_odds(body) : 0.0) + parameters_.alike * by_size;
  }

  /// Fit a body that a mask proposed to its points if these cover half of it, as they then describe it better than its
  /// outline.
  void prefer_points(Entry& e) {
    constexpr double kEnough = 0.5;
    const auto fit = free_.fit(e.fit.body, parameters_.fit);
    if (!fit || !plausible(fit->body, parameters_)) return;
    if (free_.judge(fit->body, {}).coverage < kEnough) return;
    e.fit = *fit;
    e.mask_log_odds.reset();
  }

  /// How a body is fitted to few points, to see where it ends up.
  FitParameters rough() const {
    FitParameters fit = parameters_.fit;
    fit.max_points = std::min(120, fit.max_points);
    return fit;
  }

  /// Add an entry that may win. Of nearly equal bodies only the better one is kept: most proposals for a fruit end up
  /// at the same fit.
  void keep(Entry e) {
    const auto same = [&](const Entry& other) {
      return other.alive && !other.mask_log_odds && nearly_equal(other.fit.body, e.fit.body);
    };
    const auto other = e.mask_log_odds ? entries_.end() : std::find_if(entries_.begin(), entries_.end(), same);
    if (other == entries_.end())
      entries_.push_back(std::move(e));
    else if (area(e) > area(*other))
      *other = std::move(e);
  }

  /// How much a body explains: its score times radius squared (m2) times confidence.
  static double area(const Entry& e) {
    const double r = e.fit.body.mean_radius();
    return e.verdict.score() * r * r * e.confidence;
  }

  /// Fit a candidate, first roughly to see where it ends up.
  /// @param known where others ended up; receives this one's place
  /// @return empty if it ends up where another did, or is not worth a better fit, or has none
  std::optional<EllipsoidFit> fitted(const BodyCandidate& candidate, std::vector<Ellipsoid>& known) {
    const auto first = free_.fit(candidate.body, rough());
    if (!first) {
      ++(counts_.*(candidate.doubt ? candidate.doubt : &BodyCounts::not_fitted));
      return std::nullopt;
    }
    if (std::any_of(known.begin(), known.end(), [&](const Ellipsoid& k) { return alike(k, first->body); }))
      return std::nullopt;
    known.push_back(first->body);
    if (hopeless(*first)) {
      ++(counts_.*(candidate.doubt ? candidate.doubt : &BodyCounts::doubtful));
      return std::nullopt;
    }
    auto fit = free_.fit(first->body, parameters_.fit);
    if (!fit) ++(counts_.*(candidate.doubt ? candidate.doubt : &BodyCounts::not_fitted));
    return fit;
  }

  /// Another body about the place of an entry, which explains far more of the points there. Lobed fruit, such as
  /// peppers, are no ellipsoids: a fit may settle on some lobes and leave others out. With a wide gate it takes in the
  /// surface that goes on beyond them.
  /// @param known where other entries grew to; receives this one's place
  /// @return one of `known`; null if there is no such body, or it may not win
  Outgrown* outgrow(const Entry& e, std::vector<Outgrown>& known) {
    constexpr double kFarMore = 1.3, kLobeSpread = 0.06;  // the second: lobes' standard deviation / radius
    const Verdict& v = e.verdict;
    // Points beyond those on the body are clutter near it.
    if (e.mask_log_odds || v.clutter < kFarMore - 1.0) return nullptr;
    FitParameters wide = rough();
    wide.max_noise = std::max(wide.max_noise, kLobeSpread);
    wide.noise = std::max(wide.noise, kLobeSpread * e.fit.body.mean_radius());
    const auto first = free_.fit(e.fit.body, wide);
    if (!first || alike(first->body, e.fit.body)) return nullptr;
    auto place =
        std::find_if(known.begin(), known.end(), [&](const Outgrown& o) { return alike(o.place, first->body); });
    if (place == known.end()) {
      known.push_back({first->body, e});
      place = std::prev(known.end());
      std::optional<Entry>& grown = place->entry;
      const auto fit = free_.fit(first->body, parameters_.fit);
      if (fit) {
        grown->fit = *fit;
        grown->prior = prior_of(fit->body);
      }
      if (!fit || assess(*grown)) grown.reset();
    }
    const double least = kFarMore * static_cast<double>(v.support);
    return place->entry && static_cast<double>(place->entry->verdict.support) >= least ? &*place : nullptr;
  }

  /// Whether a rough fit, to the free points near it, is so unlike a fruit that a better one is not worth its time.
  /// Size, score or roundness say so of most leaves. In a single view, which nothing follows, and with masks, which may
  /// know better, only the probability does.
  bool hopeless(const EllipsoidFit& fit) const {
    constexpr double kTooLarge = 1.3, kShareOfLeast = 0.25;  // margins: a better fit may be smaller, or rounder
    constexpr std::size_t kFlatSurely = 60;                  // points that show whether a surface is round
    const bool strict = !evidence_.single_view() && !evidence_.masks.log_odds;
    if (strict && fit.body.mean_semi_axis() > kTooLarge * parameters_.radius_max) return true;
    const Verdict v = free_.judge_quickly(fit.body, evidence_.single_view());
    if (strict && v.score() < kShareOfLeast * parameters_.min_coverage) return true;
    if (strict && v.support >= kFlatSurely && v.roundness < kShareOfLeast * parameters_.min_roundness) return true;
    const double least = 0.1 * kHopeless * parameters_.min_confidence;
    const auto below = [&](double prior) { return fruit_probability(v, fit, parameters_, prior) < least; };
    if (!evidence_.masks.log_odds) return below(0.0);
    if (below(evidence_.masks.most)) return true;  // whatever the masks say
    return below(-evidence_.masks.most) && below(prior_of(fit.body));
  }

  /// Judge an entry by the free points; it is alive while it may win.
  /// @return the count of the first test that it fails; null when it is alive
  std::size_t BodyCounts::*assess(Entry& e) const {
    e.verdict = free_.judge(e.fit.body, evidence_);
    return rate(e);
  }

  /// As assess(), by the last verdict.
  std::size_t BodyCounts::*rate(Entry& e) const {
    const bool right_size = plausible(e.fit.body, parameters_);
    e.confidence = fruit_probability(e.verdict, e.fit, parameters_, e.prior);
    if (e.mask_log_odds) {  // little of it may show: the depths under the masks have decided
      e.confidence = from_log_odds(*e.mask_log_odds - against_masks(e.fit.body, e.verdict));
      e.alive = right_size && e.confidence >= parameters_.min_confidence;
      return e.alive ? nullptr : &BodyCounts::doubtful;
    }
    e.alive = right_size && e.verdict.score() >= parameters_.min_coverage &&
              round_enough(e.verdict, e.fit.body, parameters_) &&
              e.confidence >= kHopeless * parameters_.min_confidence;
    if (e.alive) return nullptr;
    if (!right_size) return wrong_size(e.fit.body.mean_radius(), parameters_);
    if (!(e.verdict.coverage >= parameters_.min_coverage)) return &BodyCounts::little_seen;
    if (!(e.verdict.score() >= parameters_.min_coverage)) return &BodyCounts::contradicted;
    if (!round_enough(e.verdict, e.fit.body, parameters_)) return &BodyCounts::too_flat;
    return &BodyCounts::doubtful;
  }

  /// The entry to take next: of those that are alive and have enough confidence, the one with the largest score times
  /// radius squared times confidence, the first of equals; null if there is none. Entries that masks proposed come
  /// before all others, in the order of their confidence.
  Entry* best_entry() {
    Entry* best = nullptr;
    for (Entry& e : entries_)
      if (e.alive && e.mask_log_odds && (!best || e.confidence > best->confidence)) best = &e;
    if (best) return best;
    for (Entry& e : entries_)
      if (e.alive && e.confidence >= parameters_.min_confidence && (!best || area(e) > area(*best))) best = &e;
    return best;
  }

  /// Whether a body goes too deep into one of those found.
  bool clashes(const Ellipsoid& body, const std::vector<FoundBody>& found) const {
    return std::any_of(found.begin(), found.end(), [&](const FoundBody& f) {
      const double smaller = std::min(f.fit.body.mean_radius(), body.mean_radius());
      return overlap(f.fit.body, body) > parameters_.max_overlap * smaller;
    });
  }

  /// Judge the living entries near a body that has just won, and fit those again that lost points to it.
  void judge_anew(const Ellipsoid& body) {
    for (Entry& e : entries_) {
      throw_if_cancelled();
      if (!e.alive) continue;
      const double gap = (e.fit.body.center - body.center).norm() - e.fit.body.mean_radius() - body.mean_radius();
      if (gap > 0.5 * body.mean_radius()) continue;
      const std::size_t support = e.verdict.support;
      assess(e);
      if (!e.alive || e.mask_log_odds || e.verdict.support == support) continue;
      if (const auto again = free_.fit(e.fit.body, parameters_.fit)) {
        e.fit = *again;
        e.prior = prior_of(e.fit.body);
        assess(e);
      } else {
        e.alive = false;
      }
    }
  }

  const BodyParameters& parameters_;
  const BodyEvidence& evidence_;
  FreePoints<S> free_;
  std::vector<Entry> entries_;
  std::vector<Entry> entered_;    // as they were before the first body won
  std::vector<KnownSize> sizes_;  // of the fruit found then
  BodyCounts counts_;
};

}  // namespace detail

}  // namespace agrisee
