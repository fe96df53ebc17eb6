// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cia402_driver/bus/command.h"
#include "cia402_driver/canopen/master.h"
#include "cia402_driver/drive/axis.h"

namespace cia402::bus {

/// One call of the `nmt` service: a command of CiA 301, 7.2.8.3.1 for one node or all, and waiting
/// for what becomes of it.
///
/// Every command is refused while the power stage of an axis may be on. None of them is a way to
/// stop a motor: a drive that leaves the operational state or is reset has no set-points any more,
/// and whether it goes on, coasts or brakes is its own choice (6007h). quick_stop, halt and disable
/// stop.
class NmtJob {
 public:
  using Nodes = std::vector<canopen::Node*>;

  /// Sends the command. @param nodes of each axis. @param which indices in `axes`; with `all` they
  /// are all of them, and the command goes out as one frame. @return why not, in words; then
  /// nothing was sent.
  static Result<NmtJob> start(const std::string& word, const std::vector<std::size_t>& which,
                              bool all, std::vector<drive::Axis>& axes, const Nodes& nodes,
                              canopen::Master& master, Reply reply, Time now);

  /// @return true once the reply was given.
  bool step(const Nodes& nodes, Time now);
  /// Gives a failed reply; for the end of the program.
  void abandon(const std::string& why);

 private:
  struct Entry {
    std::size_t axis = 0;
    std::string who;
    bool tells = true;  ///< its heartbeat, or answers to guarding, will tell the state
    bool ended = false, success = false;
    std::string message;
  };
  void watch(Entry& entry, const canopen::Node& node, Time now) const;
  void watchBoot(Entry& entry, const canopen::Node& node, Time now) const;
  void watchState(Entry& entry, const canopen::Node& node, Time now) const;
  void lookAgain(Entry& entry, const canopen::Node& node) const;
  /// "shoulder (node 3): nmt stop: ".
  std::string about(const Entry& entry) const;
  bool staysDown() const;  ///< stop and pre_operational: until somebody boots the node
  Answer answer() const;

  std::string word_;
  canopen::NmtCommand command_ = canopen::NmtCommand::start;
  std::vector<Entry> entries_;
  Time began_{};
  Reply reply_;
};

}  // namespace cia402::bus
