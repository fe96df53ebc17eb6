// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/device.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/device/context.h"
#include "sim/device/emergency.h"
#include "sim/device/guarding.h"
#include "sim/device/heartbeat.h"
#include "sim/device/lss.h"
#include "sim/device/pdo_server.h"
#include "sim/device/sdo/server.h"
#include "sim/device/sync.h"
#include "sim/device/time.h"

namespace cia402::sim {

using canopen::NmtCommand;
using canopen::NmtState;

namespace {

constexpr std::uint32_t kNmt = 0x000;
constexpr std::uint16_t kSecondSdoParameter = 0x1201;
constexpr std::uint32_t kErrorControl = 0x700;
constexpr std::uint32_t kLssRequest = 0x7E5;
constexpr std::uint32_t kFunctionCode = 0x780;
constexpr std::uint32_t kNodeId = 0x07F;

constexpr std::uint16_t kOverrun = 0x8110;
constexpr std::uint8_t kCommunicationErrors = 0x11;  // bits of 1001h
constexpr std::uint16_t kRecoveredFromBusOff = 0x8140;
constexpr std::uint32_t kSdoRequest = 0x600;

constexpr std::uint16_t kFirstCommunicationObject = 0x1000;
constexpr std::uint16_t kLastCommunicationObject = 0x1FFF;

// Lets nothing out while the device speaks another bit rate than the bus.
class Transceiver : public can::Sink {
 public:
  explicit Transceiver(can::Sink& sink) : sink_(sink) {}
  void watch(const SlaveLss& lss) { lss_ = &lss; }
  bool send(const can::Frame& frame) override { return lss_->deaf() || sink_.send(frame); }

 private:
  can::Sink& sink_;
  const SlaveLss* lss_ = nullptr;
};

}  // namespace

struct Device::Impl {
  Transceiver transceiver;
  SlaveContext context;
  SlaveEmergency emergency{context};
  SlaveHeartbeat heartbeat{context, emergency};
  SlaveGuarding guarding{context, emergency};
  SlaveSync sync{context, emergency};
  SlaveTime clock{context};
  SdoServer sdo{context};
  SdoServer second_sdo{context, kSecondSdoParameter};
  PdoServer pdos{context, emergency};
  SlaveLss lss;
  Time boot_at = kNever;
  Time boot_again_at = kNever;
  Time jams_until = Time::min();
  unsigned boots = 0;
  std::vector<can::Frame> early_requests;  ///< of SDO, before boot-up
  Time next_event = kNever;
  unsigned depth = 0;

  Impl(canopen::NodeId node, can::Sink& sink, ObjectDictionary& dictionary,
       DeviceBehaviour behaviour, Application& application)
      : transceiver(sink),
        context(node, transceiver, dictionary, behaviour, application),
        lss(context, node) {
    transceiver.watch(lss);
    context.change_state = [this](NmtState state) { changeState(state); };
    context.reset_communication = [this] { beginBoot(false); };
  }

  ~Impl() { releaseObjects(); }

  void serveObjects();
  void releaseObjects();
  void beginBoot(bool reset_all);
  Duration bootTime();
  void takeNodeId();
  void silence(NmtState state);
  void finishBoot();
  void changeState(NmtState state);
  void command(const can::Frame& frame);
  void onSync(const can::Frame& frame);
  void hear(const can::Frame& frame);
  void dispatch(const can::Frame& frame);
  void runDue();
  Time deadline() const;
};

namespace {

/// Sets the time of a call and finds the next event when the outermost call ends: the application
/// may call the device from within its own calls.
template <typename Impl>
class Call {
 public:
  Call(Impl& impl, Time now) : impl_(impl) {
    impl_.context.now = now;
    ++impl_.depth;
  }
  ~Call() {
    if (--impl_.depth == 0) impl_.next_event = impl_.deadline();
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  Impl& impl_;
};

}  // namespace

void Device::Impl::serveObjects() {
  releaseObjects();
  emergency.serveObjects();
  heartbeat.serveObjects();
  guarding.serveObjects();
  sync.serveObjects();
  clock.serveObjects();
  second_sdo.serveObjects();
  pdos.serveObjects();
}

void Device::Impl::releaseObjects() {
  for (const ObjectId id : context.hooked) {
    context.dictionary.onWriteCheck(id, nullptr);
    context.dictionary.onWrite(id, nullptr);
    context.dictionary.onRead(id, nullptr);
  }
  context.hooked.clear();
}

// Forgets all that runs or waits; `state` is one in which nothing is sent.
void Device::Impl::silence(NmtState state) {
  context.state = state;
  boot_at = boot_again_at = kNever;
  early_requests.clear();
  pdos.stop();
  heartbeat.reset();
  guarding.reset();
  sync.reset();
  clock.reset();
  sdo.reset();
  second_sdo.reset();
  emergency.reset();
  lss.reset();
}

void Device::Impl::takeNodeId() {
  const canopen::NodeId before = context.node;
  context.node = context.application.ownNodeId().value_or(lss.pendingNode());
  if (context.node != before) context.application.onNodeId(before, context.node);
}

void Device::Impl::beginBoot(bool reset_all) {
  silence(NmtState::boot_up);
  if (reset_all) lss.load();
  takeNodeId();
  if (reset_all) {
    context.dictionary.restoreInitial();
    context.application.onPowerOn(context.now);
  } else {
    context.dictionary.restoreInitial(kFirstCommunicationObject, kLastCommunicationObject);
    context.application.onResetCommunication(context.now);
  }
  boot_at = context.now + bootTime();
  context.application.onNmtState(NmtState::boot_up, context.now);
}

/// Each node and each boot has another one.
Duration Device::Impl::bootTime() {
  const std::uint64_t turn = (++boots * 256U + context.node) * 0x9E3779B97F4A7C15U >> 48U;
  const auto part = static_cast<std::int64_t>(turn);  // of 65536
  return context.behaviour.boot_time + context.behaviour.boot_time_varies * part / 65536;
}

void Device::Impl::finishBoot() {
  boot_at = kNever;
  if (context.node == kUnconfigured) return;  // LSS waits for a node-ID
  sync.start();
  clock.start();
  pdos.configure();
  sdo.configure();
  second_sdo.configure();
  heartbeat.start();
  if (context.behaviour.boots_again_after > Duration::zero()) {
    boot_again_at = context.now + context.behaviour.boots_again_after;
  }
  changeState(NmtState::pre_operational);
  for (std::int64_t i = 0; i < context.behaviour.overruns_at_boot; ++i) {
    emergency.send(kOverrun, kCommunicationErrors, {});
  }
  for (const can::Frame& request : std::exchange(early_requests, {})) sdo.receive(request);
  if (context.behaviour.starts_operational) changeState(NmtState::operational);
}

void Device::Impl::changeState(NmtState state) {
  if (state == context.state) return;
  if (context.operational()) pdos.stop();
  if (state == NmtState::stopped) {
    sdo.reset();
    second_sdo.reset();
  }
  context.state = state;
  if (context.operational()) pdos.start();
  context.application.onNmtState(state, context.now);
  if (context.operational() && context.behaviour.sends_event_tpdos_on_start) pdos.sendOnStart();
  emergency.tick();
}

void Device::Impl::command(const can::Frame& frame) {
  if (frame.remote || frame.size != 2) return;
  if (frame.data[1] != 0 && frame.data[1] != context.node) return;
  switch (static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::start:
      if (context.behaviour.stays_pre_operational) return;
      return changeState(NmtState::operational);
    case NmtCommand::stop:
      return changeState(NmtState::stopped);
    case NmtCommand::enter_pre_operational:
      return changeState(NmtState::pre_operational);
    case NmtCommand::reset_node:
      if (context.behaviour.ignores_nmt_reset) return;
      jams_until = context.now + context.behaviour.reset_jams_bus;
      return beginBoot(true);
    case NmtCommand::reset_communication:
      if (!context.behaviour.ignores_nmt_reset) beginBoot(false);
      return;
  }
}

void Device::Impl::onSync(const can::Frame& frame) {
  if (!context.communicating()) return;
  const auto counter = sync.accept(frame);
  if (!counter) return;
  if (context.operational()) pdos.applySynchronous();
  context.application.onSync(context.now);
  if (context.operational()) pdos.sendSynchronous(*counter);
}

void Device::Impl::dispatch(const can::Frame& frame) {
  if (frame.id == sync.cobId()) return onSync(frame);
  if (context.operational() && pdos.concerns(frame.id)) return pdos.receive(frame);
  if (frame.id == kNmt) return command(frame);
  if (frame.id == clock.cobId()) return clock.receive(frame);
  if (frame.id == kLssRequest) return lss.receive(frame);
  if (sdo.concerns(frame.id)) return sdo.receive(frame);
  if (second_sdo.concerns(frame.id)) return second_sdo.receive(frame);
  if (frame.id == kErrorControl + context.node) return guarding.receive(frame);
  if ((frame.id & kFunctionCode) == kErrorControl) {
    heartbeat.receive(static_cast<canopen::NodeId>(frame.id & kNodeId), frame);
  }
}

void Device::Impl::hear(const can::Frame& frame) {
  if (lss.deaf()) return;
  if (context.state != NmtState::boot_up) return dispatch(frame);
  if (context.behaviour.answers_after_boot && frame.id == kSdoRequest + context.node) {
    early_requests.push_back(frame);
  }
  // Still initialising; without a node-ID LSS alone works, once the device has started.
  const bool waits_for_id = context.node == kUnconfigured && boot_at == kNever;
  if (waits_for_id && frame.id == kLssRequest) lss.receive(frame);
  const bool resets = context.behaviour.lss_waits_for_reset && frame.id == kNmt;
  if (waits_for_id && resets) command(frame);
}

void Device::Impl::runDue() {
  if (boot_at <= context.now) finishBoot();
  if (boot_again_at <= context.now) {
    boot_again_at = kNever;
    context.sink.send(can::Frame(kErrorControl + context.node, {0x00}));
  }
  lss.tick();
  sync.tick();
  if (const auto own = sync.takeProduced()) onSync(*own);
  heartbeat.tick();
  guarding.tick();
  pdos.tick();
  sdo.tick();
  second_sdo.tick();
  emergency.tick();
}

Time Device::Impl::deadline() const {
  return std::min({boot_at, boot_again_at, lss.deadline(), sync.deadline(), heartbeat.deadline(),
                   guarding.deadline(), pdos.deadline(), sdo.deadline(), second_sdo.deadline(),
                   emergency.deadline()});
}

Device::Device(canopen::NodeId node, can::Sink& sink, ObjectDictionary& dictionary,
               DeviceBehaviour behaviour, Application& application)
    : impl_(std::make_unique<Impl>(node, sink, dictionary, behaviour, application)) {}

Device::~Device() = default;

void Device::powerOn(Time now) {
  Call<Impl> call(*impl_, now);
  impl_->serveObjects();
  impl_->beginBoot(true);
}

void Device::powerOff() {
  impl_->silence(NmtState::unknown);
  impl_->next_event = kNever;
}

bool Device::powered() const { return impl_->context.state != NmtState::unknown; }

void Device::receive(const can::Frame& frame, Time now) {
  if (frame.extended || frame.error || !powered()) return;
  Call<Impl> call(*impl_, now);
  if (impl_->next_event <= now) impl_->runDue();
  impl_->hear(frame);
}

void Device::tick(Time now) {
  if (impl_->next_event > now) return;
  Call<Impl> call(*impl_, now);
  impl_->runDue();
}

Time Device::nextEvent() const { return impl_->next_event; }

canopen::NodeId Device::node() const { return impl_->context.node; }

canopen::NmtState Device::nmtState() const { return impl_->context.state; }

void Device::setBusBitrate(std::uint32_t bitrate) { impl_->lss.setBusBitrate(bitrate); }

void Device::sendEmergency(std::uint16_t code, std::uint8_t error_register,
                           const std::array<std::uint8_t, 5>& vendor, Time now) {
  if (!powered()) return;
  Call<Impl> call(*impl_, now);
  impl_->emergency.send(code, error_register, vendor);
}

void Device::rememberError(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) {
  if (powered()) impl_->emergency.remember(code, vendor);
}

Time Device::jamsUntil() const { return impl_->jams_until; }

std::optional<ReceivedTime> Device::lastTime() const { return impl_->clock.last(); }

void Device::onBusOff(Time now) {
  if (!powered() || impl_->context.state == NmtState::boot_up) return;
  Call<Impl> call(*impl_, now);
  impl_->context.masterLost();
}

void Device::onBusRecovered(Time now) {
  if (!powered() || impl_->context.state == NmtState::boot_up) return;
  Call<Impl> call(*impl_, now);
  bool recovered = false;
  impl_->emergency.raise(recovered, kRecoveredFromBusOff);
  impl_->emergency.resolve(recovered);
}

void Device::clearEmergency(Time now, std::uint8_t remaining) {
  if (!powered()) return;
  Call<Impl> call(*impl_, now);
  impl_->emergency.clear(remaining);
}

void Device::notifyChange(Time now) {
  if (!powered() || !impl_->context.operational() || !impl_->pdos.sendsOnChange()) return;
  Call<Impl> call(*impl_, now);
  impl_->pdos.notifyChange();
}

DeviceBehaviour& Device::behaviour() { return impl_->context.behaviour; }

}  // namespace cia402::sim
