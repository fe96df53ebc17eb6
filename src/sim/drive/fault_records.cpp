// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/fault_records.h"

#include <algorithm>
#include <cstddef>

namespace cia402::sim {
namespace {

constexpr std::uint64_t kOwnCode = 0xFF;  // of 603Fh

}  // namespace

void FaultRecords::add(const FaultDefinition& fault) {
  if (records_.empty() || fault.warning) return;
  std::rotate(records_.begin(), records_.end() - 1, records_.end());
  Record& newest = records_.front();
  newest.code = fault.code & kOwnCode;
  newest.copies.clear();
  for (const auto& copy : definition_.fault_records.front().copies) {
    const Entry* source = dictionary_.find(copy.first);
    newest.copies.push_back(source == nullptr ? 0 : source->number);
  }
  show();
}

void FaultRecords::show() {
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const FaultRecordObjects& objects = definition_.fault_records[i];
    if (Entry* code = dictionary_.find(objects.code)) code->number = records_[i].code;
    auto number = records_[i].copies.begin();
    for (const auto& copy : objects.copies) {
      if (number == records_[i].copies.end()) break;
      if (Entry* target = dictionary_.find(copy.second)) target->number = *number;
      ++number;
    }
  }
}

}  // namespace cia402::sim
