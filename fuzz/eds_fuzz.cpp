// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "canopen/eds/eds.h"
#include "input.h"

// The EDS reader on any bytes. What was read is written as a DCF and
// read again: that must give the same objects without an error.
namespace cia402::fuzz {
namespace {

using namespace canopen;

bool sameEntry(const DictionaryEntry& a, const DictionaryEntry& b) {
  return a.name == b.name && a.type == b.type && a.access == b.access && a.mappable == b.mappable &&
         a.low == b.low && a.high == b.high &&
         (sizeBits(a.type) == 0 || (a.default_value == b.default_value && a.value == b.value));
}

void checkEntry(const DictionaryEntry& entry, ObjectId id) {
  require(entry.id == id, "an entry knows its own place");
  const std::size_t size = (sizeBits(entry.type) + 7) / 8;
  for (const auto* value : {&entry.low, &entry.high, &entry.default_value, &entry.value}) {
    require(size == 0 || !*value || (*value)->size() == size, "a value is as long as its type");
    if (*value) describeValue(entry.type, **value);
  }
  if (entry.low && entry.high) {
    require(compareValues(entry.type, *entry.low, *entry.high) <= 0, "limits are in order");
  }
  if (entry.value) checkWrite(entry, *entry.value, "fuzz").ok();
}

void roundTrip(const Eds& eds) {
  EdsInfo info = eds.info;
  if (!info.node_id) info.node_id = NodeId{1};
  const Eds again = readEds(writeDcf(info, eds.dictionary));
  for (const auto& [index, object] : eds.dictionary.objects()) {
    for (const auto& [subindex, entry] : object.entries) {
      const DictionaryEntry* other = again.dictionary.find(entry.id);
      require(other != nullptr && sameEntry(entry, *other), "what was written reads back equal");
    }
  }
}

}  // namespace
}  // namespace cia402::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  const auto node_id = static_cast<canopen::NodeId>(size % 127 + 1);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const canopen::Eds eds = canopen::readEds(text, node_id);
  fuzz::require(eds.problems.size() <= canopen::kMostEdsProblems, "problems are bounded");
  fuzz::require(eds.dictionary.size() <= canopen::kMostEdsEntries + 64 * 1024,
                "entries are bounded");
  unsigned line = 0;
  for (const canopen::EdsProblem& problem : eds.problems) {
    fuzz::require(problem.line >= line && problem.line <= size + 1, "problems are in order");
    line = problem.line;
  }
  for (const auto& [index, object] : eds.dictionary.objects()) {
    for (const auto& [subindex, entry] : object.entries) {
      fuzz::checkEntry(entry, {index, subindex});
    }
  }
  if (eds.dictionary.size() < 2000) {
    fuzz::roundTrip(eds);
    for (const auto& [index, object] : eds.dictionary.objects()) {
      if (object.entries.size() == 1) eds.dictionary.find(object.name).ok();
      break;
    }
  }
  return 0;
}
