// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>
#include <vector>

#include "cia402_driver/canopen/sdo_client.h"
#include "input.h"

// The SDO client with any frames at any times, in every phase of every kind of transfer. Half of
// the frames are made from the client's own last request, as a server might answer it, for random
// bytes would hardly ever get beyond the first phase. Each transfer must end, at the latest when
// the server falls silent, exactly once; and what was uploaded is no longer than what was received.
namespace cia402::fuzz {
namespace {

using namespace canopen;

constexpr NodeId kNode = 5;
constexpr std::uint32_t kAnswerId = 0x585;

/// Keeps the last request and its number.
struct Requests : can::Sink {
  bool send(const can::Frame& frame) override {
    last = frame;
    ++count;
    require(frame.id == 0x605 && frame.size == 8, "a request is a frame of 8 bytes on 605h");
    return count % 50 != 49;  // the queue is full now and then
  }
  can::Frame last;
  std::uint64_t count = 0;
};

/// A plausible answer: the last request's object with a command of any kind.
can::Frame answer(const Requests& requests, Input& input) {
  static constexpr std::uint8_t kCommands[] = {
      0x60, 0x20, 0x30, 0x41, 0x40, 0x43, 0x4B, 0x4F, 0x00, 0x10, 0x01, 0x0F, 0x1F, 0x80,
      0xA0, 0xA1, 0xA2, 0xA4, 0xC0, 0xC2, 0xC4, 0xC6, 0xC1, 0xC5, 0xDD, 0x81, 0x82, 0xFF};
  can::Frame frame = requests.last;
  frame.id = kAnswerId;
  frame.size = 8;
  const std::uint8_t choice = input.byte();
  frame.data[0] = choice < 0xE0 ? kCommands[choice % sizeof kCommands] : input.byte();
  if (choice % 3 == 0) {
    for (std::size_t i = 4; i < 8; ++i) frame.data[i] = input.byte();
  } else if (choice % 3 == 1) {
    frame.data[4] = input.byte();
    frame.data[5] = frame.data[6] = frame.data[7] = 0;
  } else {
    for (std::size_t i = 1; i < 8; ++i) frame.data[i] = input.byte();
  }
  return frame;
}

SdoOptions readOptions(Input& input) {
  SdoOptions options;
  options.timeout = std::chrono::milliseconds(1 + input.byte());
  options.retries = input.byte() % 3;
  return options;
}

void start(SdoClient& client, Input& input, std::vector<SdoTicket>& tickets) {
  const std::uint8_t kind = input.byte();
  const ObjectId object{static_cast<std::uint16_t>(0x1000 + kind % 4), 0};
  const SdoOptions options = readOptions(input);
  if ((kind & 0x80U) == 0) {
    tickets.push_back(client.upload(object, "fuzz", options));
  } else {
    Bytes data = input.bytes(40);
    if ((kind & 0x40U) != 0) data.resize(data.size() * 50);
    tickets.push_back(client.download(object, data, "fuzz", options));
  }
}

void check(const std::vector<SdoTicket>& tickets, std::uint64_t frames) {
  for (const SdoTicket& ticket : tickets) {
    if (ticket->direction() == SdoTransfer::Direction::upload && ticket->ok()) {
      require(ticket->data().size() <= 8 * frames, "an upload holds what was received, not more");
    }
    require(ticket->done() || ticket->failure() == SdoTransfer::Failure::none,
            "a failure comes with the end");
    require(!ticket->done() || ticket->ok() || !ticket->message().empty(), "a failure is told");
  }
}

}  // namespace
}  // namespace cia402::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  if (size > 4096) return 0;
  fuzz::Input input(data, size);
  fuzz::Requests requests;
  canopen::SdoClient client(fuzz::kNode, requests, fuzz::readOptions(input));
  std::vector<canopen::SdoTicket> tickets;
  std::uint64_t frames = 0;
  Time now{};
  while (!input.empty()) {
    const std::uint8_t action = input.byte();
    if (action < 0x30) {
      if (tickets.size() < 20) fuzz::start(client, input, tickets);
      client.tick(now);
    } else if (action < 0x60) {
      now += std::chrono::milliseconds(input.byte());
      client.tick(now);
    } else if (action < 0xC0) {
      client.receive(fuzz::answer(requests, input), now);
      ++frames;
    } else if (action < 0xFC) {
      client.receive(input.frame(action < 0xF0 ? fuzz::kAnswerId : input.word() & 0x7FFU), now);
      ++frames;
    } else {
      client.cancelAll("fuzz");
    }
    fuzz::check(tickets, frames);
  }
  // The server is silent from here on: deadlines alone must end everything.
  for (int steps = 0; !client.idle(); ++steps) {
    fuzz::require(steps < 100'000, "everything ends when the server is silent");
    const Time deadline = client.nextDeadline();
    fuzz::require(deadline != kNever, "who waits has a deadline");
    if (deadline > now) now = deadline;
    client.tick(now);
  }
  fuzz::check(tickets, frames);
  for (const canopen::SdoTicket& ticket : tickets) {
    fuzz::require(ticket->done(), "each transfer ends");
    fuzz::require(ticket.use_count() == 1, "the client forgets what has ended");
  }
  return 0;
}
