// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/reader.h"

namespace cia402::canopen {

EdsReader::EdsReader(const EdsText& text, EdsProblems& problems, Eds& eds,
                     std::optional<NodeId> node_id)
    : text_(text), problems_(problems), eds_(eds), wanted_node_id_(node_id) {}

void EdsReader::read() {
  sortSections();
  readFileInfo();
  readDeviceInfo();
  readCommissioning();
  readDummies();
  readComments();
  node_id_ = wanted_node_id_.value_or(eds_.info.node_id.value_or(NodeId{0}));
  readObjects();
  adoptOrphans();
  readCompactLists();
  readLists();
  addCompactPdos();
}

Eds readEds(std::string_view text, std::optional<NodeId> node_id) {
  Eds eds;
  EdsProblems problems;
  const EdsText sections(text, problems);
  if (sections.sections().empty()) {
    problems.error(1, "this is no EDS file: there is not one section in it");
  } else {
    EdsReader(sections, problems, eds, node_id).read();
  }
  problems.moveTo(eds);
  return eds;
}

}  // namespace cia402::canopen
