// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/pdo_packing.h"

#include <algorithm>
#include <tuple>

namespace cia402::config {
namespace {

constexpr unsigned kMaxBits = 64;
constexpr std::size_t kMaxFixed = 8;                           // of which all subsets are tried
constexpr unsigned kMostSteps = 100'000, kLeastSteps = 2'000;  // of the search, for each subset

/// The lower, the better; in this order.
using Cost = std::tuple<double, double, std::size_t>;  // bits per cycle: worst, nominal; PDOs

/// A PDO that is being filled.
struct Bin {
  unsigned number = 0, bits = 0, every = 0;
  std::vector<std::size_t> items;
};

class Search {
 public:
  Search(const std::vector<PackItem>& items, const PackRules& rules)
      : items_(items), rules_(rules) {}

  std::optional<std::vector<PackedPdo>> run() {
    const std::size_t fixed = std::min(rules_.fixed.size(), kMaxFixed);
    for (std::size_t subset = 0; subset < (std::size_t{1} << fixed); ++subset) {
      steps_ = std::max(kLeastSteps, kMostSteps >> fixed);
      tryFixed(subset);
    }
    return best_;
  }

 private:
  /// Uses the fixed PDOs whose bit is set in `subset`, and distributes what they do not carry.
  void tryFixed(std::size_t subset) {
    fixed_.clear();
    std::vector<bool> carried(items_.size(), false);
    for (std::size_t f = 0; f < std::min(rules_.fixed.size(), kMaxFixed); ++f) {
      if ((subset >> f & 1U) == 0) continue;
      const FixedPdo& pdo = rules_.fixed[f];
      PackedPdo packed{pdo.number, 0, {}};
      unsigned bits = 0;
      for (const PackItem& entry : pdo.items) {
        packed.items.push_back(entry.name);
        bits += entry.bits;
        for (std::size_t i = 0; i < items_.size(); ++i) {
          if (items_[i].name != entry.name) continue;
          packed.every =
              packed.every == 0 ? items_[i].every : std::min(packed.every, items_[i].every);
          carried[i] = true;
        }
      }
      if (packed.every == 0) return;  // of no use: the subset without it is tried, too
      fixed_.emplace_back(packed, bits);
    }
    rest_.clear();
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (!carried[i]) rest_.push_back(i);
    }
    free_numbers_.clear();
    for (unsigned number = 1; number <= rules_.pdos && free_numbers_.size() < rest_.size();
         ++number) {
      const bool taken = std::any_of(rules_.fixed.begin(), rules_.fixed.end(),
                                     [&](const FixedPdo& pdo) { return pdo.number == number; });
      if (!taken) free_numbers_.push_back(number);
    }
    place(0);
  }

  void place(std::size_t next) {
    if (steps_ == 0) return;
    --steps_;
    const Cost so_far = cost();  // what is yet to be placed can only add to it
    if (best_ && !(so_far < best_cost_)) return;
    if (std::get<2>(so_far) > rules_.most) return;
    if (next == rest_.size()) return keep(so_far);
    const PackItem& item = items_[rest_[next]];
    const std::size_t open = bins_.size();  // more come and go in the search below
    for (std::size_t b = 0; b < open; ++b) {
      if (bins_[b].bits + item.bits > kMaxBits || bins_[b].items.size() >= rules_.entries) continue;
      const Bin before = bins_[b];
      bins_[b].bits += item.bits;
      bins_[b].every = std::min(bins_[b].every, item.every);
      bins_[b].items.push_back(rest_[next]);
      place(next + 1);
      bins_[b] = before;
    }
    if (bins_.size() >= free_numbers_.size() || item.bits > kMaxBits || rules_.entries == 0) return;
    bins_.push_back({free_numbers_[bins_.size()], item.bits, item.every, {rest_[next]}});
    place(next + 1);
    bins_.pop_back();
  }

  void add(Cost& cost, unsigned bits, unsigned every) const {
    const FrameBits frame = frameBits((bits + 7) / 8);
    std::get<0>(cost) += frame.worst / (rules_.may_change_every_cycle ? 1.0 : every);
    std::get<1>(cost) += frame.nominal / every;
    ++std::get<2>(cost);
  }

  Cost cost() const {
    Cost cost{0.0, 0.0, 0};
    for (const auto& [pdo, bits] : fixed_) add(cost, bits, pdo.every);
    for (const Bin& bin : bins_) add(cost, bin.bits, bin.every);
    return cost;
  }

  void keep(const Cost& cost) {
    best_cost_ = cost;
    best_.emplace();
    for (const auto& [pdo, bits] : fixed_) best_->push_back(pdo);
    for (const Bin& bin : bins_) {
      PackedPdo packed{bin.number, bin.every, {}};
      for (const std::size_t item : bin.items) packed.items.push_back(items_[item].name);
      best_->push_back(packed);
    }
    std::sort(best_->begin(), best_->end(),
              [](const PackedPdo& a, const PackedPdo& b) { return a.number < b.number; });
  }

  const std::vector<PackItem>& items_;
  const PackRules& rules_;
  std::vector<std::size_t> rest_;
  std::vector<unsigned> free_numbers_;
  std::vector<Bin> bins_;
  std::vector<std::pair<PackedPdo, unsigned>> fixed_;
  std::optional<std::vector<PackedPdo>> best_;
  Cost best_cost_{};
  unsigned steps_ = 0;
};

}  // namespace

// Nominal: SOF 1, identifier 11, RTR, IDE, r0, DLC 4, data, CRC 15 + 1, ACK 2, EOF 7, pause 3.
// Worst: of the 34 + 8n bits that are stuffed, one more after the first five and then after each
// four (Davis, Burns, Bril, Lukkien 2007).
FrameBits frameBits(unsigned bytes) {
  const unsigned stuffable = 34 + 8 * bytes;
  const unsigned nominal = 47 + 8 * bytes;
  const unsigned worst = nominal + (stuffable - 1) / 4;
  return {static_cast<double>(nominal), static_cast<double>(worst)};
}

FrameBits remoteFrameBits() { return frameBits(0); }

std::optional<std::vector<PackedPdo>> packPdos(const std::vector<PackItem>& items,
                                               const PackRules& rules) {
  return Search(items, rules).run();
}

}  // namespace cia402::config
