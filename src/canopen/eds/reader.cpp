// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string_view>

#include "canopen/eds/compact.h"
#include "canopen/eds/eds.h"
#include "canopen/eds/entry.h"
#include "canopen/eds/info.h"
#include "canopen/eds/keys.h"
#include "canopen/eds/lists.h"
#include "canopen/eds/objects.h"
#include "canopen/eds/problems.h"
#include "canopen/eds/sections.h"
#include "canopen/eds/text.h"

namespace cia402::canopen {
namespace {

void read(const EdsText& text, EdsProblems& problems, std::optional<NodeId> node_id, Eds& eds) {
  const EdsSections sections(text, problems);
  EdsKeys keys(problems);
  readEdsInfo(text, keys, problems, eds.info);
  EdsEntryReader entries(sections, keys, problems,
                         node_id.value_or(eds.info.node_id.value_or(NodeId{0})));
  EdsObjectReader objects(sections, entries, keys, problems, eds.dictionary);
  objects.read();
  readEdsCompactLists(sections, entries, keys, problems, eds.dictionary);
  checkEdsLists(text, sections, keys, problems, eds.dictionary, objects.full());
  addEdsCompactPdos(eds.info, eds.dictionary);
}

}  // namespace

Eds readEds(std::string_view text, std::optional<NodeId> node_id) {
  Eds eds;
  EdsProblems problems;
  const EdsText sections(text, problems);
  if (sections.sections().empty()) {
    problems.error(1, "this is no EDS file: there is not one section in it");
  } else {
    read(sections, problems, node_id, eds);
  }
  problems.moveTo(eds);
  return eds;
}

}  // namespace cia402::canopen
