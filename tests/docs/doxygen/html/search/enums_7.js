var searchData=
[
  ['sight_0',['Sight',['../free__space_8hpp.html#a7020aa455ff10ca0ea93b03c2fed2ea8',1,'agrisee::plan']]],
  ['stlcorners_1',['StlCorners',['../mesh__file_8hpp.html#a36e7163150bb8e3d4ce2f9c2b6c8ca54',1,'agrisee::io']]],
  ['stopreason_2',['StopReason',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadb',1,'agrisee']]]
];
