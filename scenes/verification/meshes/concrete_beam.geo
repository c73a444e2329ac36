// The notched beam of ../concrete_beam.yaml in mm: triangles, one layer of them thick. concrete_beam.msh was made by
//   gmsh -3 -format msh41 concrete_beam.geo -o concrete_beam.msh      (Gmsh 4.8.4; -setnumber position 0.7 for another notch,
// -setnumber algorithm 6 and -setnumber coarse 6 for other meshes of the same edge)
DefineConstant[ position = 0.5, fine = 1.8, coarse = 10, algorithm = 5 ];
half = 114.3; low = -38.1; high = 38.1; support = 101.6; depth = 19.05; width = 1;
notch = -support * position;
Point(1) = {-half, -fine / 2, low};
Point(2) = {-support, -fine / 2, low};
Point(3) = {notch - width / 2, -fine / 2, low};
Point(4) = {notch - width / 2, -fine / 2, low + depth};
Point(5) = {notch + width / 2, -fine / 2, low + depth};
Point(6) = {notch + width / 2, -fine / 2, low};
Point(7) = {support, -fine / 2, low};
Point(8) = {half, -fine / 2, low};
Point(9) = {half, -fine / 2, high};
Point(10) = {-half, -fine / 2, high};
For i In {1 : 9}
  Line(i) = {i, i + 1};
EndFor
Line(10) = {10, 1};
Curve Loop(1) = {1 : 10};
Plane Surface(1) = {1};
// Fine around the way from the notch to the hammer, and at midspan.
Point(11) = {notch, -fine / 2, low + depth};
Point(12) = {-8, -fine / 2, high};
Point(13) = {0, -fine / 2, low};
Point(14) = {0, -fine / 2, high};
Line(11) = {11, 12};
Line(12) = {13, 14};
Field[1] = Distance;
Field[1].CurvesList = {11, 12};
Field[1].NumPointsPerCurve = 200;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = fine; Field[2].SizeMax = coarse;
Field[2].DistMin = 10; Field[2].DistMax = 34;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = algorithm;
Extrude {0, fine, 0} { Surface{1}; Layers{1}; }
Physical Volume(1) = {1};
