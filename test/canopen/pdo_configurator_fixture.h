// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "canopen/pdo/configurator.h"
#include "canopen/scripted_peer.h"

namespace cia402::canopen::test {

using Lines = std::vector<std::string>;
using Status = PdoConfigurator::Status;

// TPDO 1 of node 3: 6041:00 (16 bits) and 6064:00 (32 bits), COB-ID 183h, every SYNC.
inline PdoConfig wantedTpdo() {
  PdoConfig pdo;
  pdo.direction = PdoDirection::tpdo;
  pdo.number = 1;
  pdo.cob_id = 0x183;
  pdo.transmission = 1;
  pdo.entries = {{{0x6041, 0}, 16, "statusword"}, {{0x6064, 0}, 32, "position"}};
  return pdo;
}

const char kReadCobId[] = "603 40 00 18 01 00 00 00 00";
const char kReadType[] = "603 40 00 18 02 00 00 00 00";
const char kReadInhibit[] = "603 40 00 18 03 00 00 00 00";
const char kReadTimer[] = "603 40 00 18 05 00 00 00 00";
const char kReadCount[] = "603 40 00 1A 00 00 00 00 00";
const char kReadEntry1[] = "603 40 00 1A 01 00 00 00 00";
const char kReadEntry2[] = "603 40 00 1A 02 00 00 00 00";
const Lines kReadAll{kReadCobId, kReadType,   kReadInhibit, kReadTimer,
                     kReadCount, kReadEntry1, kReadEntry2};

const char kDisable[] = "603 23 00 18 01 83 01 00 80";
const char kClearMap[] = "603 2F 00 1A 00 00 00 00 00";
const char kWriteEntry1[] = "603 23 00 1A 01 10 00 41 60";
const char kWriteEntry2[] = "603 23 00 1A 02 20 00 64 60";
const char kWriteCount[] = "603 2F 00 1A 00 02 00 00 00";
const char kWriteType[] = "603 2F 00 18 02 01 00 00 00";
const char kEnable[] = "603 23 00 18 01 83 01 00 00";

const char kCobIdDone[] = "583 60 00 18 01 00 00 00 00";
const char kTypeDone[] = "583 60 00 18 02 00 00 00 00";
const char kCountDone[] = "583 60 00 1A 00 00 00 00 00";
const char kEntry1Done[] = "583 60 00 1A 01 00 00 00 00";
const char kEntry2Done[] = "583 60 00 1A 02 00 00 00 00";

const char kCobIdEnabled[] = "583 43 00 18 01 83 01 00 00";
const char kCobIdDisabled[] = "583 43 00 18 01 83 01 00 80";
const char kType1[] = "583 4F 00 18 02 01 00 00 00";
const char kType255[] = "583 4F 00 18 02 FF 00 00 00";
const char kInhibit0[] = "583 4B 00 18 03 00 00 00 00";
const char kTimer0[] = "583 4B 00 18 05 00 00 00 00";
const char kCount0[] = "583 4F 00 1A 00 00 00 00 00";
const char kCount2[] = "583 4F 00 1A 00 02 00 00 00";
const char kEntry1[] = "583 43 00 1A 01 10 00 41 60";
const char kEntry2[] = "583 43 00 1A 02 20 00 64 60";

class PdoConfiguratorTest : public ::testing::Test {
 protected:
  static SdoOptions askOnce() {
    SdoOptions options;
    options.retries = 0;
    return options;
  }
  Status run(const PdoConfig& wanted, PdoConfigurator::Options options = {}) {
    configurator.emplace(client, wanted, options);
    Status status = configurator->advance();
    client.tick(now);
    peer.deliver([&](const can::Frame& answer) {
      client.receive(answer, now);
      status = configurator->advance();
      client.tick(now);
    });
    return status;
  }
  void allAsWanted() {
    peer.on(kReadCobId, kCobIdEnabled)
        .on(kReadType, kType1)
        .on(kReadInhibit, kInhibit0)
        .on(kReadTimer, kTimer0)
        .on(kReadCount, kCount2)
        .on(kReadEntry1, kEntry1)
        .on(kReadEntry2, kEntry2);
  }
  void allWritesTaken() {
    peer.on(kDisable, kCobIdDone)
        .on(kClearMap, kCountDone)
        .on(kWriteEntry1, kEntry1Done)
        .on(kWriteEntry2, kEntry2Done)
        .on(kWriteCount, kCountDone)
        .on(kWriteType, kTypeDone)
        .on(kEnable, kCobIdDone);
  }

  ScriptedPeer peer;
  SdoClient client{3, peer, askOnce()};
  std::optional<PdoConfigurator> configurator;
  Time now{};
};

}  // namespace cia402::canopen::test
