var searchData=
[
  ['reach_0',['Reach',['../plan_2planner_8hpp.html#a10bc40ff7b1fd3c5a987f957ff7f5842',1,'agrisee::plan']]],
  ['reachapproach_1',['ReachApproach',['../approach_8hpp.html#adc269de9870b460ee98eea48a467537f',1,'agrisee::plan']]],
  ['rgb_2',['Rgb',['../palette_8hpp.html#aa4a99fa81daa7df46f26543068ffd32d',1,'agrisee::io']]]
];
