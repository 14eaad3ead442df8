var searchData=
[
  ['approach_5finterrupted_0',['approach_interrupted',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3da0e48ef3e2cea6e03be170ecb547fabbb',1,'agrisee']]],
  ['arm_5fcollision_1',['arm_collision',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3da924d4a57725f4d7ea0eb880bcfc0cac5',1,'agrisee']]],
  ['arm_5fmeets_5ffruit_2',['arm_meets_fruit',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3da86f2fe3eb226687470a722eeb46328de',1,'agrisee']]]
];
