// How many steps the reference firmware drives on while nobody says anything and the line gives back what the
// robot itself says, as half-duplex lines and modules that echo do. Prints it.
#include "floor.hpp"

int main() {
  Floor floor;
  periplus::Robot robot(floor, periplus::Chassis(), 1);
  robot.begin();
  send(robot, "H 1 2A");
  send(robot, "M 1 400000 200 0 0 10000");
  int steps = 0;
  do {
    floor.step(robot);
    std::string echo;
    echo.swap(floor.said);
    for (char byte : echo) robot.receive(static_cast<uint8_t>(byte));
    ++steps;
  } while (floor.speed != 0 && steps < 400);
  printf("%d\n", steps);
}
