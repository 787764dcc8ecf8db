"""What is seen of pictures: how soon, how fine, and beside other renderers."""
