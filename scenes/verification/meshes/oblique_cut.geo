// The block of ../oblique_cut.yaml in mm: a prism along z, cut by a plane whose normal leans by 60 degrees from z to x.
// oblique_cut.msh was made by
//   gmsh -3 -format msh41 -bin oblique_cut.geo -o oblique_cut.msh      (Gmsh 4.8.4)
SetFactory("OpenCASCADE");
edge = 5;
Box(1) = {-10, -10, -20, 20, 20, 40};
Rectangle(100) = {-60, -20, 0, 120, 40};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi / 3} { Surface{100}; }
BooleanFragments{ Volume{1}; Delete; }{ Surface{100}; Delete; }
Physical Volume("block") = {Volume{:}};
Mesh.CharacteristicLengthMin = edge;
Mesh.CharacteristicLengthMax = edge;
