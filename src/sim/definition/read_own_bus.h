// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/definition/effect.h"
#include "sim/definition/maker_states.h"
#include "sim/definition/monitors.h"
#include "sim/definition/own_bus.h"
#include "sim/definition/reader.h"
#include "sim/dictionary/template.h"

namespace cia402::sim {

/// The `own_bus:` section.
void readOwnBus(DefinitionReader& reader, OwnBusDefinition& out);
/// The `maker_states:` section.
void readMakerStates(DefinitionReader& reader, MakerStates& out);
/// The `effective:` section: lists of objects and of stretches of sub-indices, "2003:03-14".
void readEffects(DefinitionReader& reader, Effects& out);
/// `monitors:`, and the `counters:` section.
void readMonitors(DefinitionReader& reader, MonitorsDefinition& out);
void readAtAlarm(DefinitionReader& reader, MonitorsDefinition& out);
void readCounters(DefinitionReader& reader, MonitorsDefinition& out);
/// The `clamped:` list of such. @param dictionary where they must have a range.
void readClamped(DefinitionReader& reader, const DictionaryTemplate& dictionary,
                 std::vector<fieldbus::ObjectId>& out);

}  // namespace cia402::sim
