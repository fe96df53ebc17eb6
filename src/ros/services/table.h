// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// All services of the node, a source each beside this table.
#pragma once

#include "ros/services/offer.h"

namespace cia402::ros_node {

void offerTriggers(Offer& offer);
void offerSetMode(Offer& offer);
void offerNmt(Offer& offer);
void offerDumpRecording(Offer& offer);
void offerReload(Offer& offer);
void offerLss(Offer& offer);
void offerErrorHistory(Offer& offer);
void offerSetPosition(Offer& offer);
void offerObjects(Offer& offer);
void offerSaveDcf(Offer& offer);
void offerDigitalOutputs(Offer& offer);
void offerTouchProbe(Offer& offer);
void offerBusParameters(Offer& offer);
void offerLoadDcf(Offer& offer);
void offerFactoryReset(Offer& offer);
void offerQueryState(Offer& offer);

/// A row of the table: what offers it, and whether for the bus, for each axis, for each group.
struct ServiceEntry {
  void (*offer)(Offer&);
  bool of_bus, of_axis, of_group = false;
};
// clang-format off
inline constexpr ServiceEntry kServices[] = {
    {offerTriggers, true, true, true},
    {offerSetMode, true, true, true},
    {offerNmt, true, true},
    {offerDumpRecording, true, false},
    {offerReload, true, false},
    {offerLss, true, false},
    {offerErrorHistory, false, true},
    {offerSetPosition, false, true},
    {offerObjects, false, true},
    {offerSaveDcf, false, true},
    {offerDigitalOutputs, false, true},
    {offerTouchProbe, false, true},
    {offerBusParameters, false, true},
    {offerLoadDcf, false, true},
    {offerFactoryReset, false, true},
    {offerQueryState, false, false, true},
};
// clang-format on

}  // namespace cia402::ros_node
