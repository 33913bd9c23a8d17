// Steps that the reference firmware takes to stand once a motion of it brakes by itself, because its time is
// up: on its own, and with the stop byte coming then; and the second of a robot of a quarter of the acceleration.
// Prints the three.
#include <stdio.h>

#include "periplus_robot.hpp"

namespace {
// A robot on an endless floor; its wheels do what they are told.
struct Floor : periplus::Hardware {
  double way = 0, speed = 0;
  uint64_t us = 0;

  uint64_t micros() override { return us; }
  void drive(float ahead, float) override { speed = ahead; }
  void ticks(int32_t* left, int32_t* right) override { *left = *right = static_cast<int32_t>(way / 0.0005); }
  double heading() override { return 0; }
  uint16_t switches() override { return 0; }
  bool bumper() override { return false; }
  void write(const char*, size_t) override {}
};

void send(periplus::Robot& robot, const char* body) {
  char line[periplus::kLongestLine];
  size_t count = 0;
  while (body[count]) ++count;
  const int all = snprintf(line, sizeof line, "%s*%04X\n", body, periplus::crc16(body, count));
  for (int k = 0; k < all; ++k) robot.receive(static_cast<uint8_t>(line[k]));
}

int steps(bool stopped, int32_t acceleration) {
  Floor floor;
  periplus::Chassis chassis;
  chassis.acceleration = acceleration;
  periplus::Robot robot(floor, chassis, 1);
  robot.begin();
  send(robot, "H 1 2A");
  send(robot, "M 1 400000 200 0 0 1000");
  double before = 0;
  for (int k = 0, braking = 0; k < 500; ++k) {
    send(robot, "P 1 0");
    floor.us += 20000;
    floor.way += floor.speed * 0.02;
    robot.step();
    if (braking == 0 && floor.speed < before && stopped) robot.receive(periplus::kStopByte);
    if (braking > 0 || floor.speed < before) ++braking;
    if (braking > 0 && floor.speed == 0) return braking;
    before = floor.speed;
  }
  return -1;
}
}  // namespace

int main() { printf("%d %d %d\n", steps(false, 1000), steps(true, 1000), steps(true, 250)); }
