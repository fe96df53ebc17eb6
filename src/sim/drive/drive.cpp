// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/sim/drive/drive.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "sim/definition/drive_definition.h"
#include "sim/drive/core.h"
#include "sim/drive/parameter_store.h"

namespace cia402::sim {
namespace {

constexpr Duration kPowerCycle = std::chrono::milliseconds(500);
constexpr Duration kStormInterval = std::chrono::milliseconds(1);
constexpr unsigned kChatters = 6;
constexpr Duration kChatterInterval = std::chrono::milliseconds(80);
constexpr std::uint16_t kStormCode = 0x6100;  // internal software

// Error register bits of a code's class (CiA 301, 7.2.7.1 and 7.5.2.2).
std::uint8_t registerFor(std::uint16_t code) {
  switch (code >> 12) {
    case 0x2:
      return 0x03;
    case 0x3:
      return 0x05;
    case 0x4:
      return 0x09;
    case 0x8:
      return (code & 0xFF00) == 0x8600 ? 0x21 : 0x11;
    default:
      return 0x01;
  }
}

// Lets nothing out while the drive plays dead.
class Gate : public can::Sink {
 public:
  explicit Gate(can::Sink& sink) : sink_(sink) {}
  bool send(const can::Frame& frame) override { return closed || sink_.send(frame); }
  bool closed = false;

 private:
  can::Sink& sink_;
};

}  // namespace

struct Drive::Impl : Device::Application, DriveCore::Reports {
  Impl(std::shared_ptr<const DriveDefinition> drive_definition, canopen::NodeId node,
       can::Sink& sink, const AxisMechanics& axis_mechanics, const DriveIdentity& identity)
      : definition(std::move(drive_definition)),
        mechanics(axis_mechanics),
        dictionary(build(*definition, node, identity)),
        gate(sink),
        device(node, gate, dictionary, definition->communication, *this),
        core(*definition, mechanics, dictionary, *this),
        store(
            dictionary, [this] { return !definition->stores_while_enabled && core.enabled(); },
            [this] { core.onParametersStored(); }) {
    installHooks();
  }

  static ObjectDictionary build(const DriveDefinition& definition, canopen::NodeId node,
                                const DriveIdentity& identity) {
    ObjectDictionary built = definition.dictionary.build(node);
    const std::optional<std::uint32_t> numbers[] = {identity.vendor, identity.product,
                                                    identity.revision, identity.serial};
    for (std::uint8_t i = 0; i < 4; ++i) {
      Entry* entry = built.find({0x1018, static_cast<std::uint8_t>(i + 1)});
      if (entry == nullptr || !numbers[i]) continue;
      entry->number = entry->initial_number = *numbers[i];
    }
    return built;
  }

  void installHooks() {
    for (const auto& pair : dictionary.entries()) {
      const Entry& entry = pair.second;
      if (entry.access != Access::rw && entry.access != Access::wo) continue;
      if (entry.id.index < 0x2000) continue;
      const auto role = roleOf(entry);
      dictionary.onWriteCheck(entry.id, [this](const Entry& e, std::uint64_t number) {
        return core.refuseWrite(e, number);
      });
      const Encoding encoding = encodingOf(entry);
      if (role || encoding != Encoding::integer) {
        dictionary.onWrite(entry.id,
                           [this, role, encoding](const Entry& e) { written(e, role, encoding); });
      }
    }
  }

  std::optional<Role> roleOf(const Entry& entry) const {
    for (const auto& moved : definition->objects) {
      if (moved.second == entry.id) return moved.first;
    }
    return findRole(entry.id);
  }

  Encoding encodingOf(const Entry& entry) const {
    const auto special = definition->encodings.find(entry.id);
    if (special != definition->encodings.end()) return special->second;
    const auto role = roleOf(entry);
    return role && roleInfo(*role).quantity != Quantity::none ? definition->encoding
                                                              : Encoding::integer;
  }

  void written(const Entry& entry, std::optional<Role> role, Encoding encoding) {
    if (encoding != Encoding::integer && badFloat(decodeNumber(entry, encoding))) {
      ++non_finite;
      core.onNonFinite();
      return;
    }
    if (role == Role::controlword) core.onControlword();
    if (role == Role::mode) core.onMode();
    if (role == Role::target_position) core.onTargetPosition();
    if (role == Role::clear_errors && entry.number != 0) core.resetFault();
    if (role == Role::save_zero && entry.number != 0) core.saveZero();
    if (role == Role::homing_start && entry.number == 1) core.onHomingStart();
  }

  bool badFloat(double value) const {
    if (!std::isfinite(value)) return definition->traps_non_finite;
    return value == 0.0 && std::signbit(value) && definition->traps_negative_zero;
  }

  // Device::Application
  void onPowerOn(Time time) override {
    now = time;
    heard = false;
    core.start(cold, time);
    cold = false;
  }
  std::optional<canopen::NodeId> ownNodeId() const override {
    const Entry* entry = definition->node_id ? dictionary.find(*definition->node_id) : nullptr;
    if (entry == nullptr) return {};
    return static_cast<canopen::NodeId>(entry->initial_number);
  }
  void onNodeId(canopen::NodeId before, canopen::NodeId now_is) override {
    for (const ObjectId id : definition->dictionary.nodeIdObjects()) {
      store.moveDefault(id, std::int64_t{now_is} - before);
    }
  }
  void onResetCommunication(Time) override {}  // the power drive system goes on
  void onNmtState(canopen::NmtState state, Time) override {
    core.onNmtState(state);
    if (state == canopen::NmtState::pre_operational && !heard) core.onBootedAlone();
  }
  void onSync(Time) override { core.onSync(); }
  void onMasterLost(Time) override { core.onMasterLost(); }
  bool hasFault() const override { return core.hasFault(); }

  // DriveCore::Reports
  void emergency(const FaultDefinition& fault, std::uint8_t error_register) override {
    device.sendEmergency(fault.code, error_register, fault.vendor, now);
    if (!definition->quirks.emergency_chatter) return;
    chatter = {&fault, error_register, kChatters, now + kChatterInterval};
  }
  void errorsGone() override {
    const bool chatters = definition->quirks.emergency_chatter;
    for (unsigned i = 0; i < (chatters ? kChatters : 1); ++i) device.clearEmergency(now);
    chatter.at = kNever;
  }

  // The EMCY of a fault ends and comes again though the fault stays, at last it stands.
  void tickChatter() {
    if (chatter.at > now) return;
    const bool ends = chatter.left-- % 2 == 0;
    if (ends) {
      device.clearEmergency(now);
    } else {
      device.sendEmergency(chatter.fault->code, chatter.error_register, chatter.fault->vendor, now);
    }
    chatter.at = chatter.left == 0 ? kNever : now + kChatterInterval;
  }

  void bringTo(Time time) {
    now = std::max(now, time);
    if (restart_at && now >= *restart_at) {
      const Time at = *restart_at;
      restart_at.reset();
      core.advance(at);
      cold = true;
      device.powerOn(at);
    }
    core.advance(now);
  }

  // An EMCY a millisecond that changes nothing else, until the fault is cleared.
  void storm() {
    if (storm_at > now) return;
    storm_at = now + kStormInterval;
    const auto count = static_cast<std::uint8_t>(++storm_count);
    device.sendEmergency(kStormCode, 0x01, {count, 0, 0, 0, 0}, now);
  }

  // Another drive of the same kind takes this one's place: other serial number, as from the
  // factory.
  void exchange() {
    store.restore(1);
    Entry* serial = dictionary.find({0x1018, 4});
    if (serial != nullptr) ++serial->initial_number;
  }

  void flushChanges() {
    if (device.powered()) device.notifyChange(now);
  }

  std::shared_ptr<const DriveDefinition> definition;
  AxisMechanics mechanics;
  ObjectDictionary dictionary;
  Gate gate;
  Device device;
  DriveCore core;
  ParameterStore store;
  Time now{};
  std::optional<Time> restart_at;
  std::map<std::uint16_t, FaultDefinition> raw_faults;
  unsigned non_finite = 0;
  Time storm_at = kNever;
  unsigned storm_count = 0;
  struct Chatter {
    const FaultDefinition* fault = nullptr;
    std::uint8_t error_register = 0;
    unsigned left = 0;
    Time at = kNever;
  } chatter;
  bool heard = false;  ///< anything, since power-on
  bool cold = false;
  bool first_power = true;
};

Drive::Drive(std::shared_ptr<const DriveDefinition> definition, canopen::NodeId node,
             can::Sink& sink, AxisMechanics mechanics, const DriveIdentity& identity)
    : impl_(std::make_unique<Impl>(std::move(definition), node, sink, mechanics, identity)) {}

Drive::~Drive() = default;

void Drive::powerOn(Time now) {
  impl_->bringTo(now);
  impl_->restart_at.reset();
  impl_->cold = !impl_->first_power;  // at first an incremental counter stands where the rotor is
  impl_->first_power = false;
  impl_->device.powerOn(now);
}

void Drive::powerOff(Time now) {
  impl_->bringTo(now);
  impl_->restart_at.reset();
  impl_->device.powerOff();
  impl_->core.powerOff();
}

void Drive::receive(const can::Frame& frame, Time now) {
  impl_->bringTo(now);
  impl_->heard = impl_->heard || !impl_->gate.closed;
  if (!impl_->gate.closed) impl_->device.receive(frame, now);
  impl_->flushChanges();
}

void Drive::tick(Time now) {
  impl_->bringTo(now);
  impl_->device.tick(now);
  impl_->storm();
  impl_->tickChatter();
  impl_->flushChanges();
}

Time Drive::nextEvent() const {
  Time next = std::min(
      {impl_->device.nextEvent(), impl_->core.nextEvent(), impl_->storm_at, impl_->chatter.at});
  if (impl_->restart_at) next = std::min(next, *impl_->restart_at);
  return next;
}

Result<void> Drive::inject(const std::string& fault, Time now) {
  Impl& impl = *impl_;
  impl.bringTo(now);
  if (const FaultDefinition* known = impl.definition->fault(fault)) {
    impl.core.raise(*known);
  } else if (fault == "power_cycle" || fault == "exchange") {
    powerOff(now);
    if (fault == "exchange") impl.exchange();
    impl.restart_at = now + kPowerCycle;
  } else if (fault == "silent") {
    impl.gate.closed = true;
  } else if (fault == "sdo_silent") {
    impl.device.behaviour().sdo_silent = true;
  } else if (fault == "emergency_storm") {
    impl.storm_at = now;
    impl.storm();
  } else if (fault == "short_tpdos" || fault == "long_tpdos") {
    impl.device.behaviour().tpdo_size_error = fault == "short_tpdos" ? -1 : 1;
  } else if (fault == "blocked_rotor") {
    impl.core.blockRotor(true);
  } else if (fault == "clear") {
    impl.gate.closed = false;
    impl.storm_at = kNever;
    impl.device.behaviour().sdo_silent = impl.definition->communication.sdo_silent;
    impl.device.behaviour().tpdo_size_error = impl.definition->communication.tpdo_size_error;
    impl.core.removeCauses();
  } else {
    char* end = nullptr;
    const bool raw = fault.compare(0, 2, "0x") == 0;
    const unsigned long code = raw ? std::strtoul(fault.c_str(), &end, 16) : 0;
    if (code == 0 || code > 0xFFFF || *end != '\0') {
      std::string names;
      for (const std::string& name : faultNames()) names += (names.empty() ? "" : ", ") + name;
      return Error{"no fault '" + fault + "' in the simulated drive " + impl.definition->name +
                   " (node " + std::to_string(impl.device.node()) + "); known: " + names +
                   ", or an error code like 0x7305"};
    }
    FaultDefinition& made = impl.raw_faults[static_cast<std::uint16_t>(code)];
    made.name = fault;
    made.code = static_cast<std::uint16_t>(code);
    made.error_register = registerFor(made.code);
    impl.core.raise(made);
  }
  impl.flushChanges();
  return {};
}

std::vector<std::string> Drive::faultNames() const {
  std::vector<std::string> names;
  for (const FaultDefinition& fault : impl_->definition->faults) names.push_back(fault.name);
  for (const char* name : {"blocked_rotor", "clear", "emergency_storm", "exchange", "long_tpdos",
                           "power_cycle", "sdo_silent", "short_tpdos", "silent"}) {
    names.emplace_back(name);
  }
  return names;
}

DriveTruth Drive::truth(Time now) {
  impl_->bringTo(now);
  const DriveMotion& motion = impl_->core.motion();
  DriveTruth truth;
  truth.position_turns = motion.motor().position();
  truth.velocity_turns = motion.motor().velocity();
  truth.power_stage_on = motion.powered();
  truth.moving = std::fabs(truth.velocity_turns) > 1e-3;
  truth.statusword = impl_->core.statusword();
  truth.mode = static_cast<int>(impl_->core.mode());
  truth.nmt = impl_->device.nmtState();
  truth.bad_floats_received = impl_->non_finite;
  return truth;
}

Device& Drive::device() { return impl_->device; }
ObjectDictionary& Drive::dictionary() { return impl_->dictionary; }
AxisMechanics& Drive::mechanics() { return impl_->mechanics; }

}  // namespace cia402::sim
