// How many bytes the reference firmware writes at once, in one call of receive(), poll() or step(), after hours of
// driving: the introduction, one step with everything due but edges, and one poll in which all switches change. Prints the
// three for a robot of the standard body, and for one of 16 switches and the longest names.
#include "floor.hpp"

namespace {
// A robot that has come round some walls; what it writes is counted.
struct Old : periplus::Hardware {
  uint64_t us = 36000000000ull;
  uint16_t closed = 0;
  size_t written = 0;

  uint64_t micros() override { return us; }
  void drive(float, float) override {}
  void ticks(int32_t* left, int32_t* right) override { *left = 7654321; *right = 7654123; }
  double heading() override { return -123.456789; }
  uint16_t switches() override { return closed; }
  bool bumper() override { return false; }
  int battery_mv() override { return 11100; }
  void write(const char*, size_t count) override { written += count; }
};

void bursts(const periplus::Chassis& chassis) {
  Old old;
  periplus::Robot robot(old, chassis, 0xFFFFFFFF);
  robot.begin();
  old.written = 0;
  send(robot, "H 1 FFFFFFFF");
  const size_t greeting = old.written;
  char body[periplus::kLongestLine];
  for (unsigned long events = 0; events < 20000; events += static_cast<unsigned long>(chassis.switches)) {
    snprintf(body, sizeof body, "P 1 %lu", events);
    send(robot, body);
    old.closed = static_cast<uint16_t>(~old.closed);
    robot.poll();
  }
  send(robot, "P 1 99999");
  old.written = 0;
  old.closed = static_cast<uint16_t>(~old.closed);
  robot.poll();
  const size_t edges = old.written;
  // A motion that ends, a report and all repetitions fall into one step sooner or later.
  size_t step = 0;
  for (unsigned seq = 1; seq < 60; ++seq) {
    snprintf(body, sizeof body, "R %u 1", seq + 4000000000u);
    send(robot, body);
    for (unsigned wait = 0; wait < 1 + seq % 5; ++wait) {
      old.us += 20000;
      old.written = 0;
      robot.step();
      if (old.written > step) step = old.written;
    }
    if (seq % 8 == 0) {
      send(robot, "P 1 99999");
      old.closed = static_cast<uint16_t>(~old.closed);
      robot.poll();
    }
  }
  printf("%zu %zu %zu\n", greeting, step, edges);
}
}  // namespace

int main() {
  periplus::Chassis chassis;
  bursts(chassis);
  chassis.switches = periplus::kMostSwitches;
  chassis.name = "forty letters are as many as are printed";
  for (auto& mount : chassis.mount) {
    mount.name = chassis.name;
    mount.angle = -3141592;
  }
  bursts(chassis);
}
