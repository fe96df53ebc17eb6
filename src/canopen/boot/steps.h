// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "canopen/boot/context.h"

// The steps of the boot procedure, each in the file that its comment names.
namespace cia402::canopen {

using BootStepPointer = std::unique_ptr<BootStep>;

// boot/identify.cpp: is somebody there, and who is it?
BootStepPointer makeBootUpWait();
BootStepPointer makeProofOfLife();
BootStepPointer makeIdentification();
// boot/brake.cpp: a motor that turns on is braked where its stop would let it go: before it leaves
// its NMT state, or, where it did not answer then, once it is identified.
BootStepPointer makeBrake(bool identified);
// boot/wake.cpp: out of the NMT state stopped, before anything is asked.
BootStepPointer makeWake();
// boot/writes.cpp: what stops a drive that was left enabled, before anything else is written to it.
BootStepPointer makeStop();
// boot/restore.cpp: factory settings (1011h), where asked for.
BootStepPointer makeRestore();
// boot/supervise.cpp: heartbeat or guarding, both ways.
BootStepPointer makeErrorControl();
// boot/half_floats.cpp: floats of 16 bits that the family has in 32.
BootStepPointer makeHalfFloatSearch();
// boot/unchanged.cpp: may the configuration be left as it is (1020h)?
BootStepPointer makeUnchangedCheck();
BootStepPointer makeSignature();
// boot/widths.cpp: how long it holds what its profile leaves open.
BootStepPointer makeWidths();
// boot/cob_ids.cpp: identifiers of SYNC and EMCY (1005h, 1014h).
BootStepPointer makeCobIds();
// boot/sync.cpp: SYNC counter and period (1019h, 1006h).
BootStepPointer makeSyncSetup();
// boot/writes.cpp: the start-up writes that go before the PDOs.
BootStepPointer makeEarlyWrites();
// boot/pdos.cpp
BootStepPointer makePdos(const NodeConfig& config);
// boot/writes.cpp: the other start-up writes of profile and user.
BootStepPointer makeStartupWrites();
// boot/kept_values.cpp: what its RPDOs shall carry of objects that no cycle sets.
BootStepPointer makeKeptValues();
// boot/start.cpp: operational, and does it say so?
BootStepPointer makeStart();

}  // namespace cia402::canopen
