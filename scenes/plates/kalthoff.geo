// Half of Kalthoff and Winkler's plate: 100 × 100 mm, a slit of 50 mm at 25 mm above the plane of symmetry z = 0, one layer of 2 mm.
// `gmsh -3 kalthoff.geo -o kalthoff.msh` made kalthoff.msh.
h = 0.0022;
Point(1) = {0, 0, 0, h}; Point(2) = {0.1, 0, 0, h}; Point(3) = {0.1, 0, 0.1, h}; Point(4) = {0, 0, 0.1, h};
Point(5) = {0, 0, 0.0253, h}; Point(6) = {0.05, 0, 0.025, h}; Point(7) = {0, 0, 0.0247, h};
For i In {1:6}
  Line(i) = {i, i + 1};
EndFor
Line(7) = {7, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};
Plane Surface(1) = {1};
plate[] = Extrude {0, 0.002, 0} { Surface{1}; Layers{1}; };
Physical Volume("plate") = {plate[1]};
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
