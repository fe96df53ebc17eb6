// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/error_frame.h"
#include "common/text.h"

#include <cstddef>
#include <iterator>

namespace cia402::can {
namespace {

struct Name {
  std::uint32_t code;
  const char* text;
};

constexpr Name kControllerStatus[] = {
    {controller_status::kRxOverflow, "receive buffer overflow, frames were lost"},
    {controller_status::kTxOverflow, "transmit buffer overflow"},
    {controller_status::kRxWarning, "controller error warning (receive)"},
    {controller_status::kTxWarning, "controller error warning (transmit)"},
    {controller_status::kRxPassive, "controller error passive (receive)"},
    {controller_status::kTxPassive, "controller error passive (transmit)"},
    {controller_status::kActive, "controller error active again"},
};

constexpr Name kViolation[] = {
    {0x01, "single bit error"},
    {0x02, "frame format error"},
    {0x04, "bit stuffing error"},
    {0x08, "unable to send a dominant bit"},
    {0x10, "unable to send a recessive bit"},
    {0x20, "bus overload"},
    {0x40, "active error announcement"},
    {0x80, "on transmission"},
};

constexpr Name kLocation[] = {
    {0x03, "start of frame"},
    {0x02, "identifier bits 28-21"},
    {0x06, "identifier bits 20-18"},
    {0x04, "substitute RTR"},
    {0x05, "identifier extension"},
    {0x07, "identifier bits 17-13"},
    {0x0F, "identifier bits 12-5"},
    {0x0E, "identifier bits 4-0"},
    {0x0C, "RTR"},
    {0x0D, "reserved bit 1"},
    {0x09, "reserved bit 0"},
    {0x0B, "data length code"},
    {0x0A, "data"},
    {0x08, "CRC sequence"},
    {0x18, "CRC delimiter"},
    {0x19, "ACK slot"},
    {0x1B, "ACK delimiter"},
    {0x1A, "end of frame"},
    {0x12, "intermission"},
};

constexpr Name kTransceiver[] = {
    {0x04, "CANH has no wire"},        {0x05, "CANH is shorted to battery"},
    {0x06, "CANH is shorted to VCC"},  {0x07, "CANH is shorted to ground"},
    {0x40, "CANL has no wire"},        {0x50, "CANL is shorted to battery"},
    {0x60, "CANL is shorted to VCC"},  {0x70, "CANL is shorted to ground"},
    {0x80, "CANL is shorted to CANH"},
};

template <std::size_t N>
std::string codeText(const Name (&names)[N], std::uint32_t code) {
  for (const Name& name : names) {
    if (name.code == code) return name.text;
  }
  return "code " + hexText(code, 1);
}

template <std::size_t N>
std::string flagText(const Name (&names)[N], std::uint32_t flags, const char* none) {
  std::string text;
  for (const Name& name : names) {
    if ((flags & name.code) == 0) continue;
    if (!text.empty()) text += ", ";
    text += name.text;
  }
  return text.empty() ? none : text;
}

std::string protocolText(const Frame& frame) {
  std::string text = "protocol violation: " + flagText(kViolation, frame.data[2], "unspecified");
  if (frame.data[3] != 0) text += " at " + codeText(kLocation, frame.data[3]);
  return text;
}

std::string lostArbitrationText(const Frame& frame) {
  if (frame.data[0] == 0) return "lost arbitration";
  return "lost arbitration in bit " + std::to_string(frame.data[0]);
}

std::string transceiverText(const Frame& frame) {
  const std::string unspecified = "transceiver fault";
  return frame.data[4] == 0 ? unspecified
                            : unspecified + ": " + codeText(kTransceiver, frame.data[4]);
}

std::string counterText(const Frame& frame) {
  return "transmit errors " + std::to_string(frame.data[6]) + ", receive errors " +
         std::to_string(frame.data[7]);
}

// One row for each class: how it reads.
struct Class {
  std::uint32_t bit;
  const char* fixed;                  // or, if null,
  std::string (*text)(const Frame&);  // from the data
};

constexpr Class kClasses[] = {
    {error_class::kBusOff, "bus-off: the controller has left the bus", nullptr},
    {error_class::kRestarted, "controller restarted after bus-off", nullptr},
    {error_class::kController, nullptr,
     [](const Frame& frame) {
       return flagText(kControllerStatus, frame.data[1], "unspecified controller problem");
     }},
    {error_class::kNoAcknowledge, "no other node acknowledged a frame", nullptr},
    {error_class::kProtocol, nullptr, protocolText},
    {error_class::kTransceiver, nullptr, transceiverText},
    {error_class::kBusError, "bus error", nullptr},
    {error_class::kLostArbitration, nullptr, lostArbitrationText},
    {error_class::kTxTimeout, "transmission timed out", nullptr},
    {error_class::kCounters, nullptr, counterText},
};

}  // namespace

std::string describeErrorFrame(const Frame& frame) {
  std::string text;
  std::uint32_t unknown = frame.id & 0x1FFFFFFFU;
  const auto append = [&](const std::string& part) {
    if (!text.empty()) text += "; ";
    text += part;
  };
  for (const Class& row : kClasses) {
    if ((frame.id & row.bit) == 0) continue;
    unknown &= ~row.bit;
    append(row.fixed != nullptr ? row.fixed : row.text(frame));
  }
  if (unknown != 0) append("unknown error class " + hexText(unknown, 1));
  return text.empty() ? "error frame without a class" : text;
}

BusState stateAfter(const Frame& error_frame, BusState before) {
  using namespace controller_status;
  if (!error_frame.error) return before;
  if ((error_frame.id & error_class::kBusOff) != 0) return BusState::bus_off;
  if ((error_frame.id & error_class::kController) != 0) {
    const std::uint8_t status = error_frame.data[1];
    if ((status & (kRxPassive | kTxPassive)) != 0) return BusState::error_passive;
    if ((status & (kRxWarning | kTxWarning)) != 0) return BusState::error_warning;
    if ((status & kActive) != 0) return BusState::error_active;
  }
  if ((error_frame.id & error_class::kRestarted) != 0) return BusState::error_active;
  return before;
}

const char* errorClassName(std::size_t bit) {
  static constexpr const char* kNames[] = {
      "transmission timeout",
      "lost arbitration",
      "controller",
      "protocol violation",
      "transceiver",
      "no acknowledge",
      "bus-off",
      "bus error",
      "restarted",
      "error counters",
  };
  return bit < std::size(kNames) ? kNames[bit] : "unknown";
}

void countErrorFrame(const Frame& error_frame, BusCounters& counters) {
  ++counters.error_frames;
  for (std::size_t bit = 0; bit < counters.error_classes.size(); ++bit) {
    counters.error_classes[bit] += error_frame.id >> bit & 1U;
  }
  if (reportsReceiveOverflow(error_frame)) ++counters.receive_overflows;
}

bool reportsReceiveOverflow(const Frame& error_frame) {
  return error_frame.error && (error_frame.id & error_class::kController) != 0 &&
         (error_frame.data[1] & controller_status::kRxOverflow) != 0;
}

}  // namespace cia402::can
