// The strip of ../slow_strip.yaml in mm: tets without planes of their own. slow_strip_5.msh and slow_strip_35.msh were
// made by
//   gmsh -3 -format msh41 -bin -setnumber edge 5 slow_strip.geo -o slow_strip_5.msh      (Gmsh 4.8.4; edge 3.5)
SetFactory("OpenCASCADE");
DefineConstant[ edge = 5 ];
Box(1) = {-30, -10, -5, 60, 20, 10};
Physical Volume("strip") = {1};
Mesh.CharacteristicLengthMin = edge;
Mesh.CharacteristicLengthMax = edge;
