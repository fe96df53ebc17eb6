// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/nmt_job.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bus/canopen/node_unit.h"
#include "bus/network.h"
#include "common/text.h"

namespace cia402::bus {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using fieldbus::Health;

constexpr struct {
  const char* word;
  NmtCommand command;
} kWords[] = {
    {"start", NmtCommand::start},
    {"stop", NmtCommand::stop},
    {"pre_operational", NmtCommand::enter_pre_operational},
    {"reset_node", NmtCommand::reset_node},
    {"reset_communication", NmtCommand::reset_communication},
};
constexpr char kMayTurn[] =
    "its motor may still turn as it was told last, and NMT does not stop a motor";
constexpr Duration kLeastWait = std::chrono::seconds(1);
constexpr Duration kStandstill = std::chrono::milliseconds(50);  // of the host, between two cycles
constexpr int kBootTimes = 4;  // boot time-outs until a boot that does not end is given up

std::optional<NmtCommand> commandOf(const std::string& word) {
  for (const auto& known : kWords) {
    if (word == known.word) return known.command;
  }
  return {};
}

/// @param alone the other axes of the device are not asked themselves
std::string refusal(drive::Axis& axis, const canopen::Node& node, const std::string& word,
                    NmtCommand command, bool alone) {
  if (command == NmtCommand::start) return {};  // at most, it boots
  const std::string refused = drive::whoIs(axis.config()) + ": nmt " + word + " is refused: ";
  const bool may_be_reset = node.config().reset_node_allowed || node.config().reset_does_nothing;
  if (command == NmtCommand::reset_node && !may_be_reset) {
    return refused +
           "by its profile (nmt_reset_node) the drive must not get that command; use "
           "reset_communication, or switch the drive off and on";
  }
  if (axis.procedure().running) {
    return refused + toString(axis.procedure().kind) + " runs (" + axis.procedure().step +
           "); wait for its end, or stop it by halt, quick_stop or disable";
  }
  const Health health = axis.device().health();
  const bool may_turn = axis.mayMove();
  if (health == Health::booting && may_turn) {
    return refused + "the drive is being configured, " + kMayTurn +
           "; wait for the end of the boot, which stops it first";
  }
  if (health == Health::lost && may_turn) {
    return refused + "the drive is lost, " + kMayTurn +
           "; recover stops it before all else, as soon as it is heard";
  }
  if (health != Health::ready) return {};
  const std::string others = alone ? axis.deviceRefusal() : std::string();
  if (!others.empty()) return refused + others;
  const drive::AxisState& state = axis.state();
  if (state.feedback_valid && drive::powerStageOff(state.state, state.statusword)) return {};
  return refused + "the axis is not disabled (" +
         (state.feedback_valid ? toString(state.state) : "no fresh statusword") +
         "), and NMT does not stop a motor: what a drive does without set-points is its own "
         "choice; quick_stop or disable it first";
}

}  // namespace

void NmtServiceCommand::begin(Network& network, const Reply<>& reply, Time now) const {
  const bool all = axis.empty();
  std::vector<NmtJob::Item> items;
  for (AxisUnit& unit : network.cycle().units()) {
    const bool concerned = all || unit.axis.config().name == axis;
    if (concerned) items.push_back({&unit.axis, &network.nodes().ofAxis(unit.index).node()});
  }
  if (items.empty()) return refuse(reply, noSuchAxis(axis));
  auto job = NmtJob::start(command, items, all, network.master(), reply, now);
  if (!job) return refuse(reply, job.error().message);
  network.tell(Event::Severity::info,
               "nmt " + command + " to " + (all ? "all nodes" : axis) + " was asked for", now);
  network.cycle().jobs().add(std::move(job).value());
}

NmtJob::NmtJob(std::string word, NmtCommand command, Reply<> reply, Time now)
    : Job(Turn::device, Ends::at_once),
      word_(std::move(word)),
      command_(command),
      began_(now),
      counts_from_(now),
      stepped_(now),
      reply_(std::move(reply)) {}

Result<std::unique_ptr<Job>> NmtJob::start(const std::string& word, const std::vector<Item>& items,
                                           bool all, canopen::Master& master, Reply<> reply,
                                           Time now) {
  const auto command = commandOf(word);
  if (!command) {
    std::string known;
    for (const auto& entry : kWords) append(known, entry.word, ", ");
    return Error{"nmt: unknown command \"" + word + "\"; there are " + known};
  }
  for (const Item& item : items) {
    const std::string why = refusal(*item.axis, *item.node, word, *command, !all);
    if (!why.empty()) return Error{why};
  }
  std::unique_ptr<NmtJob> job(new NmtJob(word, *command, std::move(reply), now));
  for (const Item& item : items) job->command(item, all, now);
  if (all && *command != NmtCommand::start) master.commandAll(*command, now);
  return std::unique_ptr<Job>(std::move(job));
}

void NmtJob::command(const Item& item, bool all, Time now) {
  canopen::Node& node = *item.node;
  const bool again = std::any_of(entries_.begin(), entries_.end(),
                                 [&](const Entry& entry) { return entry.node == &node; });
  const bool mute = node.health() == Health::ready && !node.supervision().watched;
  const bool tells = node.config().heartbeat > Duration::zero() && !mute;
  entries_.push_back({&node, item.axis, tells, false, false, {}});
  if (again) return;  // another axis of the same node
  if (command_ == NmtCommand::start) {
    const bool needed = node.health() != Health::ready && node.health() != Health::booting;
    // A drive that is not configured must not be started as it is: its PDOs may mean anything.
    if (needed) node.boot(now, false);
  } else if (!all) {
    node.command(command_, now);
  }
}

bool NmtJob::step(Time now) {
  if (now > stepped_ + kStandstill) counts_from_ = now;
  stepped_ = now;
  for (Entry& entry : entries_) {
    // While the others are waited for, one that was operational may be none any more.
    const bool may_leave = entry.success && !staysDown();
    if (!entry.ended || may_leave) watch(entry, now);
  }
  const bool ended =
      std::all_of(entries_.begin(), entries_.end(), [](const Entry& e) { return e.ended; });
  if (!ended) return false;
  if (staysDown()) {
    for (Entry& entry : entries_) lookAgain(entry);
  }
  give(reply_, answer());
  return true;
}

/// While the others were waited for, a later call may have booted a node again.
void NmtJob::lookAgain(Entry& entry) const {
  const Health health = entry.node->health();
  if (!entry.success || (health != Health::ready && health != Health::booting)) return;
  entry.success = false;
  entry.message = about(entry) + "the drive did so, but by now it is configured and started again";
}

std::string NmtJob::about(const Entry& entry) const {
  return drive::whoIs(entry.axis->config()) + ": nmt " + word_ + ": ";
}

bool NmtJob::staysDown() const {
  return command_ == NmtCommand::stop || command_ == NmtCommand::enter_pre_operational;
}

void NmtJob::watch(Entry& entry, Time now) const {
  if (now <= began_) return;
  if (staysDown()) {
    watchState(entry, now);
  } else {
    watchBoot(entry, now);
  }
  if (!entry.ended) return;
  entry.message = about(entry) + entry.message + entry.axis->neighbourText();
}

/// Start and the resets end with the node configured and operational, by what it told since.
void NmtJob::watchBoot(Entry& entry, Time now) const {
  const canopen::Node& node = *entry.node;
  const Health health = node.health();
  const Duration patience = kBootTimes * node.config().boot_timeout + kLeastWait;
  // An older heartbeat may not have told yet that the drive left that state.
  const bool told = !node.supervision().watched || (node.lastHeartbeat() > counts_from_ &&
                                                    node.nmtState() == NmtState::operational);
  entry.success = health == Health::ready && told;
  entry.ended = entry.success || health == Health::failed || health == Health::absent ||
                now >= began_ + patience;
  if (entry.success) {
    const bool was_reset = command_ != NmtCommand::start;
    entry.message = std::string("the drive is configured and operational") +
                    (was_reset ? "; it is disabled" : "");
    const bool in_vain = command_ == NmtCommand::reset_node && node.config().reset_does_nothing;
    if (in_vain) {
      entry.message +=
          ". It does nothing by that command (nmt_reset_node of its profile): switch it off and "
          "on for a start";
    }
  } else if (entry.ended) {
    entry.message = "sent, but the node is not operational: " +
                    (health == Health::ready  ? "its heartbeat does not say so"
                     : node.problem().empty() ? node.bootStep()
                                              : node.problem());
  }
}

void NmtJob::watchState(Entry& entry, Time now) const {
  const canopen::Node& node = *entry.node;
  const NmtState wanted =
      command_ == NmtCommand::stop ? NmtState::stopped : NmtState::pre_operational;
  const bool heard = node.nmtState() == wanted && node.lastHeartbeat() > began_;
  const Duration heartbeat = node.config().heartbeat;
  entry.success = heard || !entry.tells;
  entry.ended = entry.success || now >= began_ + std::max(kLeastWait, 3 * heartbeat);
  if (heard) {
    entry.message = std::string("the drive is ") + canopen::toString(wanted) +
                    "; `start` or `recover` configures and starts it again";
  } else if (!entry.tells) {
    entry.message = "sent; the drive has no heartbeat to tell whether it obeyed";
  } else if (entry.ended) {
    entry.message =
        std::string("sent, but the drive's heartbeat says ") + canopen::toString(node.nmtState());
  }
}

Answer NmtJob::answer() const {
  Answer answer;
  const auto succeeded = std::count_if(entries_.begin(), entries_.end(),
                                       [](const Entry& entry) { return entry.success; });
  answer.success = static_cast<std::size_t>(succeeded) == entries_.size();
  if (entries_.size() > 1) {
    answer.message = "nmt " + word_ + " done on " + std::to_string(succeeded) + " of " +
                     std::to_string(entries_.size()) + " nodes";
  }
  for (const Entry& entry : entries_) {
    if (entries_.size() > 1 && entry.success) continue;
    append(answer.message, entry.message);
  }
  return answer;
}

void NmtJob::abandon(const std::string& why) { refuse(reply_, "nmt " + word_ + ": " + why); }

}  // namespace cia402::bus
