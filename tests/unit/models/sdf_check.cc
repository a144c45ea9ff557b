// Reads a file as Gazebo does, and prints the number of its links, joints and sensors.
#include <iostream>
#include <sdf/sdf.hh>

int main(int, char **argv)
{
  sdf::Root root;
  const auto errors = root.Load(argv[1]);
  for (const auto &error : errors)
    std::cerr << error << "\n";
  const sdf::Model *model = root.Model();
  if (!errors.empty() || !model)
    return 1;
  std::cout << model->LinkCount() << " " << model->JointCount() << " "
            << model->LinkByName("base_link")->SensorCount() << "\n";
}
