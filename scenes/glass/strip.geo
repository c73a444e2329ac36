// A strip of 80 x 40 mm (in mm) with a slit across its middle. strip.msh was made by
//   gmsh -0 -format msh41 -bin strip.geo -o strip.msh                                                      (Gmsh 4.8.4)
// The slit goes `from` a height `to` another; one that starts at -20 begins in the strip's edge.
SetFactory("OpenCASCADE");
DefineConstant[ edge = 2, thickness = 4, from = -10, to = 10 ];
near = 1e-3;
Box(1) = {-40, -20, 0, 80, 40, thickness};
Point(101) = {0, from, 0};
Point(102) = {0, to, 0};
Point(103) = {0, to, thickness};
Point(104) = {0, from, thickness};
Line(101) = {101, 102};
Line(102) = {102, 103};
Line(103) = {103, 104};
Line(104) = {104, 101};
Curve Loop(101) = {101, 102, 103, 104};
Plane Surface(101) = {101};
BooleanFragments{ Volume{1}; Delete; }{ Surface{101}; Delete; }

slit() = Surface In BoundingBox{-near, from - near, -near, near, to + near, thickness + near};
mouth() = Curve In BoundingBox{-near, from - near, -near, near, to + near, thickness + near};
mouth() -= Curve In BoundingBox{-near, to - near, -near, near, to + near, thickness + near};
If (from > -20)
  mouth() -= Curve In BoundingBox{-near, from - near, -near, near, from + near, thickness + near};
EndIf
Physical Volume("strip") = Volume{:};
Physical Surface(2) = slit();
Physical Curve(3) = mouth();
Mesh.CharacteristicLengthMin = edge;
Mesh.CharacteristicLengthMax = edge;
Mesh.Algorithm3D = 10;
Mesh 3;
Plugin(Crack).Dimension = 2;
Plugin(Crack).PhysicalGroup = 2;
Plugin(Crack).OpenBoundaryPhysicalGroup = 3;
Plugin(Crack).Run;
