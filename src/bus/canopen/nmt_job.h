// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bus/canopen/nmt_command.h"
#include "bus/jobs/job.h"
#include "canopen/master.h"
#include "cia402_driver/common/result.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// One call of the `nmt` service: a command of CiA 301, 7.2.8.3.1 for one node or all, and waiting
/// for what becomes of it.
///
/// Every command is refused while the power stage of an axis may be on. None of them is a way to
/// stop a motor: a drive that leaves the operational state or is reset has no set-points any more,
/// and whether it goes on, coasts or brakes is its own choice (6007h). quick_stop, halt and disable
/// stop.
class NmtJob final : public Job {
 public:
  /// One axis and the node that it sits in.
  struct Item {
    drive::Axis* axis = nullptr;
    canopen::Node* node = nullptr;
  };

  /// Sends the command. @param all the items are all axes, and the command goes out as one frame.
  /// @return why not, in words; then nothing was sent.
  static Result<std::unique_ptr<Job>> start(const std::string& word, const std::vector<Item>& items,
                                            bool all, canopen::Master& master, Reply<> reply,
                                            Time now);

  bool step(Time now) override;
  void abandon(const std::string& why) override;

 private:
  struct Entry {
    canopen::Node* node = nullptr;
    const drive::Axis* axis;
    bool tells = true;  ///< its heartbeat, or answers to guarding, will tell the state
    bool ended = false, success = false;
    std::string message;
  };

  NmtJob(std::string word, canopen::NmtCommand command, Reply<> reply, Time now);
  void command(const Item& item, bool all, Time now);
  void watch(Entry& entry, Time now) const;
  void watchBoot(Entry& entry, Time now) const;
  void watchState(Entry& entry, Time now) const;
  void lookAgain(Entry& entry) const;
  /// "shoulder (node 3): nmt stop: ".
  std::string about(const Entry& entry) const;
  bool staysDown() const;  ///< stop and pre_operational: until somebody boots the node
  Answer answer() const;

  std::string word_;
  canopen::NmtCommand command_;
  std::vector<Entry> entries_;
  Time began_;
  /// What was heard before tells nothing: it began then, or the host had stood still until then,
  /// and a drive that missed its master may have left its state.
  Time counts_from_;
  Time stepped_;
  Reply<> reply_;
};

}  // namespace cia402::bus
