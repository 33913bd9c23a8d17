// Steps for which the reference firmware drives on once the bumper is pressed while a motion of it brakes
// because its time is up. Prints them, and the reason that is told.
#include "floor.hpp"

int main() {
  Floor floor;
  periplus::Robot robot(floor, periplus::Chassis(), 1);
  robot.begin();
  send(robot, "H 1 2A");
  send(robot, "M 1 400000 200 0 0 1000");
  double before = 0;
  int steps = 0;
  for (int k = 0; k < 500 && !(floor.pressed && floor.speed == 0); ++k) {
    send(robot, "P 1 0");
    floor.step(robot);
    steps += floor.pressed;
    if (floor.speed < before) floor.pressed = true;
    before = floor.speed;
  }
  char why[8] = "none";
  const size_t done = floor.said.find("\nd 1 ");
  if (done != std::string::npos) sscanf(floor.said.c_str() + done, " d %*d %*d %7s", why);
  printf("%d %s\n", steps, why);
}
