// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/canopen/reload_command.h"
#include "bus/jobs/job.h"
#include "canopen/node/node.h"

namespace cia402::bus {

/// Writes into drives what a reload has for them, one object after the other, then has the bus take
/// over the rest. Meanwhile no axis takes a procedure but those that stop.
class ReloadJob final : public Job {
 public:
  /// @param network must outlive the job.
  ReloadJob(Network& network, const ReloadCommand& command, Reply<ReloadAnswer> reply);

  bool step(Time now) override;
  /// Nothing is taken back: who drives the drives next configures them anew.
  void abandon(const std::string& why) override;

 private:
  enum class Stage : std::uint8_t { writing, comparing, undoing };
  struct Item {
    canopen::Node* node;
    Reload::Writes::Item* item;
  };

  /// The next of those that can be written now, or the end.
  bool next(Time now);
  bool takeWritten(Time now);
  bool takeReadBack(Time now);
  /// What became of its transfer, which has failed.
  std::string textOf(const Item& item) const;
  /// Takes back what was written last, or ends.
  bool undo();
  bool fail(const std::string& why);
  void finish(const ReloadAnswer& answer);

  Network& network_;
  std::shared_ptr<Reload> reload_;
  Reply<ReloadAnswer> reply_;
  std::vector<Item> items_;
  std::size_t at_ = 0;
  std::vector<Item> taken_;  ///< by their drives
  Stage stage_ = Stage::writing;
  std::string failure_, remarks_;
  fieldbus::Ticket ticket_;
};

}  // namespace cia402::bus
