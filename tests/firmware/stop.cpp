// Steps that the reference firmware takes to stand once a motion of it brakes by itself, because its time is
// up: on its own, and with the stop byte coming then; and the second of a robot of a quarter of the acceleration.
// Prints the three.
#include "floor.hpp"

namespace {
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
    floor.step(robot);
    if (braking == 0 && floor.speed < before && stopped) robot.receive(periplus::kStopByte);
    if (braking > 0 || floor.speed < before) ++braking;
    if (braking > 0 && floor.speed == 0) return braking;
    before = floor.speed;
  }
  return -1;
}
}  // namespace

int main() { printf("%d %d %d\n", steps(false, 1000), steps(true, 1000), steps(true, 250)); }
