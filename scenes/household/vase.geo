// A turned vase: 200 mm high, walls of 6 mm. `shiver mesh vase.geo --script --edge 0.006` made vase.msh.
SetFactory("OpenCASCADE");
Point(1) = {0, 0, 0};
Point(2) = {0.040, 0, 0};
Point(3) = {0.062, 0, 0.060};
Point(4) = {0.046, 0, 0.140};
Point(5) = {0.026, 0, 0.170};
Point(6) = {0.036, 0, 0.200};
Point(7) = {0.030, 0, 0.200};
Point(8) = {0.020, 0, 0.170};
Point(9) = {0.040, 0, 0.140};
Point(10) = {0.056, 0, 0.060};
Point(11) = {0.035, 0, 0.008};
Point(12) = {0, 0, 0.008};
Line(1) = {1, 2};
Spline(2) = {2, 3, 4, 5, 6};
Line(3) = {6, 7};
Spline(4) = {7, 8, 9, 10, 11};
Line(5) = {11, 12};
Line(6) = {12, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Extrude {{0, 0, 1}, {0, 0, 0}, 2*Pi} { Surface{1}; }
