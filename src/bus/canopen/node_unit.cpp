// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/node_unit.h"

#include <algorithm>
#include <memory>

#include "bus/canopen/history_job.h"
#include "canopen/pdo/text.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

using fieldbus::Health;

constexpr Duration kPdoNewsInterval = std::chrono::seconds(1);
constexpr unsigned kHistoryAfterFault = 4;                      // entries
constexpr Duration kHistoryInterval = std::chrono::seconds(5);  // at least, between two readings

/// Boot has found a COB-ID that canopen::receivedIdentifiers() did not foresee.
bool hasOwnCobIds(const canopen::Node& node, const NodeUnit::Foreseen& foreseen) {
  const auto& tpdos = node.image().tpdos();
  return std::any_of(tpdos.begin(), tpdos.end(), [&](const canopen::PdoImage::Pdo& pdo) {
    return pdo.cob_id < foreseen.size() && !foreseen[pdo.cob_id];
  });
}

NodeSnapshot snapshotOf(const canopen::Node& node, const NodeUnit::Foreseen& foreseen) {
  NodeSnapshot snapshot;
  snapshot.changes = node.changes();
  snapshot.nmt = node.nmtState();
  snapshot.last_heartbeat = node.lastHeartbeat();
  snapshot.boot_ups = node.bootUps();
  if (node.identity()) snapshot.identity = *node.identity();
  snapshot.supervision = node.supervision();
  snapshot.sdo = node.sdo().counters();
  snapshot.may_be_absent = node.excused();
  snapshot.own_cob_ids = hasOwnCobIds(node, foreseen);
  return snapshot;
}

}  // namespace

void NodeUnit::onBootUp(Time now) {
  // Part of the boot, which is told when it has ended; the second may come of factory settings.
  if (++boot_ups_ > 2) axis().reporter.bootUp(now);
}

void NodeUnit::onHealthChange(Time now) {
  for (const Entry& entry : axes_) entry.unit->axis.onHealthChange();
  const Health health = node_->health();
  if (health == Health::booting) {
    boot_began_ = now;
  } else {
    boot_ups_ = 0;
  }
  const bool asked_for = health == Health::booting || cycle_->shutdown().begun();
  if (asked_for) return;
  if (health == Health::ready) return tellBooted(now);
  std::string text = node_->problem();  // names the node itself
  if (text.empty()) text = node_->who() + ": " + toString(health);
  const bool excused = node_->excused();
  if (excused) text += "; it is optional, the others go on without it";
  tell(*events_, excused ? Event::Severity::warning : Event::Severity::error, text, now);
}

/// One line in the log; what else there is to say of the boot stands in the words of the axes.
void NodeUnit::tellBooted(Time now) {
  const std::string booted = "booted in " + secondsText(now - boot_began_, 2);
  const std::string warnings = joined(node_->notes());
  std::string words = booted;
  if (!warnings.empty()) append(words, warnings);
  const std::string remarks = joined(node_->remarks());
  if (!remarks.empty()) append(words, remarks);
  for (const Entry& entry : axes_) entry.unit->news.say(&AxisWords::boot, words);
  const bool well = warnings.empty();
  tell(*events_, well ? Event::Severity::info : Event::Severity::warning,
       node_->who() + ": " + booted + ": " +
           (well ? "identified, configured and started" : "it works, but " + warnings),
       now);
}

void NodeUnit::onEmergency(const fieldbus::Emergency& emergency, const std::string& excuse,
                           Time now) {
  for (const Entry& entry : axes_) {
    entry.unit->axis.onEmergency(emergency, now, excuse);
    if (entry.unit == &axis()) {
      entry.unit->reporter.emergency(emergency, now, excuse);
    } else {
      entry.unit->reporter.count(emergency);
    }
  }
}

void NodeUnit::onMalformedEmergency(std::size_t size, Time now) {
  axis().reporter.malformedEmergency(size, now);
}

void NodeUnit::watchPdos(Time now) {
  const canopen::PdoImage& image = node_->image();
  const bool short_or_long = image.wrongLengths() != wrong_lengths_;
  const bool stale = image.staleCount() != stale_count_;
  if (now < pdos_told_ + kPdoNewsInterval) return;
  pdos_told_ = now;
  const std::string overdue = canopen::staleText(image);
  for (const Entry& entry : axes_) entry.unit->news.say(&AxisWords::stale, overdue);
  const std::string who = node_->who() + ": ";
  if (short_or_long) {
    tell(*events_, Event::Severity::warning,
         who + canopen::wrongLengthText(image) +
             "; the drive maps other objects than configured, or another device uses that COB-ID",
         now);
  }
  if (stale && !overdue.empty() && !node_->paused()) {
    tell(*events_, Event::Severity::warning,
         who + overdue +
             ": its values are stale and shown as unknown; check cable, bus load and "
             "the drive's TPDOs",
         now);
  }
  wrong_lengths_ = image.wrongLengths();
  stale_count_ = image.staleCount();
  troubles_ = image.troubles();
}

/// After a fault, but not in quick succession.
void NodeUnit::readHistory(AxisUnit& axis, Time now) {
  const auto entry =
      std::find_if(axes_.begin(), axes_.end(), [&](const Entry& e) { return e.unit == &axis; });
  const bool recently =
      entry->history_asked != Time() && now < entry->history_asked + kHistoryInterval;
  if (recently || cycle_->shutdown().begun()) return;
  entry->history_asked = now;
  axis.news.explainFault();
  cycle_->jobs().add(std::make_unique<HistoryJob>(
      axis.axis, kHistoryAfterFault,
      [&axis, node = node_, cycle = cycle_, events = events_](const canopen::ErrorHistory& read) {
        const std::string text = historyText(*axis.axis.config().profile, read);
        axis.news.say(&AxisWords::history, text);
        if (!read.readable) return;  // many drives keep none
        tell(*events, Event::Severity::info,
             node->who() + ": the drive's " + historyTitle(*axis.axis.config().profile) +
                 ", newest first: " + text,
             cycle->now());
      }));
}

void NodeUnit::fillNode(NodeSnapshot& snapshot, const Foreseen& foreseen) const {
  snapshot = snapshotOf(*node_, foreseen);
}

}  // namespace cia402::bus
