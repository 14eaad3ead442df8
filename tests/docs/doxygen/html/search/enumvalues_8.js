var searchData=
[
  ['max_5fviews_0',['max_views',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadba27be6f4114233ce25c4f3a44654784d3',1,'agrisee']]],
  ['merge_1',['merge',['../mesh__file_8hpp.html#a36e7163150bb8e3d4ce2f9c2b6c8ca54a65464c31b2e6ac04da1fcaa37c9bd9c7',1,'agrisee::io']]]
];
